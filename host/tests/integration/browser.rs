//! The report in a real browser: everything is drawn, nothing complains, nothing asks for the network.
//!
//! Runs where there is a Chromium; on Unix only, where the browser and all
//! the processes that it starts are one group that ends with the test. The page forbids itself all network
//! access (its Content-Security-Policy), so that a wish for it is an error in the browser's console.

use crate::report::embedded;
use crate::support::{arg, data, run};
use servoid_test_support::tools::missing;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A page of this size takes two seconds; a loaded machine ten times that.
const LIMIT: Duration = Duration::from_secs(90);

/// A page around the page, as wide as is asked for: a browser's window is never as narrow as a telephone.
/// It asks what only a running page knows, once all is drawn, and writes it to its own attributes.
const PROBE: &str = r#"<!DOCTYPE html><html><body><script>
"use strict";
const seen = document.documentElement.dataset, frame = document.querySelector("iframe");
(async () => {
  const inner = () => frame.contentDocument.documentElement;
  while (!inner()?.dataset.drawn) await new Promise((done) => setTimeout(done, 20));
  const page = frame.contentWindow, root = inner();
  seen.drawn = root.dataset.drawn;
  seen.overflow = root.scrollWidth - page.innerWidth;
  seen.dark = page.matchMedia("(prefers-color-scheme: dark)").matches;
  const plots = [...frame.contentDocument.querySelectorAll(".figure")];
  seen.traces = plots.map((plot) => plot.id + ":" + plot.dataset.traces).join(" ");
  seen.wide = plots.filter((plot) => plot.querySelector(".main-svg").getBoundingClientRect().right > page.innerWidth).map((plot) => plot.id).join(" ");
  seen.buttons = [...plots[1].querySelectorAll(".modebar-btn")].map((button) => button.dataset.title).join();
  page.Plotly.Fx.hover(plots[0], { xval: 80 }, ["xy"]);
  while (!plots[0].querySelector(".hoverlayer text")) await new Promise((done) => setTimeout(done, 20));
  seen.hover = [...plots[0].querySelectorAll(".hoverlayer text")].map((text) => text.textContent).join(" | ");
  for (const format of ["svg", "png"]) {
    const image = await page.Plotly.toImage(plots[0], { format, width: 600, height: 400 });
    seen[format] = image.slice(0, 20) + " " + image.length;
  }
  seen.probed = "yes";
})();
</script></body></html>"#;

/// The page in a frame of this width, with the questions.
fn probed(page: &str, width: u32) -> String {
    let page = page.replace('&', "&amp;").replace('"', "&quot;");
    let frame =
        format!("<body><iframe width=\"{width}\" height=\"800\" srcdoc=\"{page}\"></iframe>");
    PROBE.replace("<body>", &frame)
}

fn chromium() -> Option<&'static str> {
    ["chromium", "chromium-browser", "google-chrome"]
        .into_iter()
        .find(|name| {
            let mut ask = Command::new(name);
            let asked = ask
                .arg("--version")
                .stdout(Stdio::null())
                .stderr(Stdio::null());
            asked.status().is_ok_and(|status| status.success())
        })
}

/// The browser with all that it starts; it ends with this value.
struct Browser(Child);

impl Drop for Browser {
    fn drop(&mut self) {
        let group = format!("-{}", self.0.id());
        let _gone_already = Command::new("kill")
            .args(["-KILL", "--", &group])
            .stderr(Stdio::null())
            .status();
        let _reaped = self.0.wait();
    }
}

/// Opens a page; returns what the browser printed: the page as it came to be, and its log.
fn browse(browser: &str, dir: &Path, page: &Path, options: &[&str]) -> (String, String) {
    use std::os::unix::process::CommandExt;
    let profile = tempfile::tempdir_in(dir).unwrap();
    let (out, log) = (profile.path().join("out"), profile.path().join("log"));
    let child = Command::new(browser)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--no-first-run",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
            "--disable-dev-shm-usage",
            "--enable-logging=stderr",
            "--host-resolver-rules=MAP * ~NOTFOUND",
        ])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .args(options)
        .arg(format!("file://{}", page.display()))
        .stdin(Stdio::null())
        .stdout(std::fs::File::create(&out).unwrap())
        .stderr(std::fs::File::create(&log).unwrap())
        .process_group(0)
        .spawn()
        .expect("it has answered before");
    let mut browser = Browser(child);
    let started = Instant::now();
    while browser.0.try_wait().unwrap().is_none() {
        assert!(
            started.elapsed() < LIMIT,
            "the browser hangs with {options:?}"
        );
        std::thread::sleep(Duration::from_millis(50));
    }
    drop(browser);
    let read = |path: &Path| String::from_utf8_lossy(&std::fs::read(path).unwrap()).into_owned();
    (read(&out), read(&log))
}

/// The value of a `data-` attribute, wherever it is first.
fn attribute<'a>(page: &'a str, name: &str) -> &'a str {
    let start = format!("data-{name}=\"");
    let value = page.split_once(&start).map(|(_, rest)| rest);
    value
        .and_then(|rest| rest.split('"').next())
        .unwrap_or_default()
}

/// Runs a side, so that every kind of figure is there.
fn made_page(dir: &Path) -> PathBuf {
    let capture = |servo: &str, seed: u64| {
        let file = dir.join(format!("{servo}-{seed}.csv"));
        let port = format!("sim:{servo}?scatter=all&seed={seed}");
        run(&[
            "capture",
            "-q",
            "--port",
            &port,
            "--condition",
            servo,
            "-o",
            arg(&file),
        ]);
        file
    };
    let (a, b) = (
        [capture("bench", 1), capture("bench", 2)],
        capture("aircraft", 1),
    );
    let page = dir.join("report.html");
    run(&[
        "report",
        "-q",
        "--a",
        arg(&a[0]),
        arg(&a[1]),
        "--b",
        arg(&b),
        "-o",
        arg(&page),
    ]);
    page
}

/// The browser; where there is none, `test` is said to be missing it.
fn chromium_for(test: &str) -> Option<&'static str> {
    let browser = chromium();
    if browser.is_none() {
        missing(test, "there is no chromium (apt-get install chromium)");
    }
    browser
}

#[test]
fn every_plot_is_drawn_and_nothing_goes_wrong() {
    let Some(browser) = chromium_for("the report in a browser") else {
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let page = made_page(dir.path());
    let text = std::fs::read_to_string(&page).unwrap();
    let figures = embedded(&text, "figures");
    let figures = figures.as_array().unwrap();
    assert!(
        figures.len() >= 15,
        "the answer, Figs 4-12, difference, structure, residuals, runs"
    );

    let expected: Vec<String> = figures
        .iter()
        .map(|figure| {
            (
                figure["name"].as_str().unwrap(),
                figure["data"].as_array().unwrap().len(),
            )
        })
        .map(|(name, traces)| format!("{name}:{traces}"))
        .collect();

    // Wide and light, and as narrow as a telephone and dark.
    for (width, scheme, dark) in [(1280, "1", "false"), (400, "0", "true")] {
        let around = dir.path().join("around.html");
        std::fs::write(&around, probed(&text, width)).unwrap();
        let options = [
            "--dump-dom",
            "--virtual-time-budget=30000",
            "--window-size=1300,900",
            &format!("--blink-settings=preferredColorScheme={scheme}"),
        ];
        let (dom, log) = browse(browser, dir.path(), &around, &options);
        let complaints: Vec<&str> = log
            .lines()
            .filter(|line| line.contains("CONSOLE"))
            .collect();
        assert!(complaints.is_empty(), "{width}: {complaints:?}");
        assert_eq!(
            attribute(&dom, "drawn"),
            figures.len().to_string(),
            "{width}"
        );
        assert_eq!(attribute(&dom, "probed"), "yes", "{width}");
        assert_eq!(attribute(&dom, "dark"), dark);
        let overflow: i32 = attribute(&dom, "overflow").parse().unwrap();
        assert!(overflow <= 0, "{width}: {overflow} pixels too wide");
        assert_eq!(
            attribute(&dom, "wide"),
            "",
            "{width}: plots beyond the edge"
        );
        // The value and its band, in milliseconds.
        let hover = attribute(&dom, "hover");
        assert!(
            hover.contains(" ms | ") && hover.contains(" .. "),
            "{width}: {hover}"
        );
        let drawn: Vec<&str> = attribute(&dom, "traces").split(' ').collect();
        assert_eq!(drawn, expected, "{width}");
        for format in ["svg", "png"] {
            let button = format!("save as {}", format.to_uppercase());
            assert!(attribute(&dom, "buttons").contains(&button));
            let image = attribute(&dom, format);
            assert!(
                image.starts_with(&format!("data:image/{format}")),
                "{width}: {image}"
            );
        }
    }

    let pdf = dir.path().join("report.pdf");
    let print = format!("--print-to-pdf={}", pdf.display());
    let (_, log) = browse(
        browser,
        dir.path(),
        &page,
        &[&print, "--virtual-time-budget=30000"],
    );
    assert!(!log.contains("CONSOLE"), "{log}");
    let printed = std::fs::read(&pdf).unwrap();
    // Each of the figures is some ten thousand bytes of lines.
    assert!(
        printed.starts_with(b"%PDF") && printed.len() > 10_000 * figures.len(),
        "{} bytes",
        printed.len()
    );
}

/// Makes the page narrower once its figures are there, and says how far it and its widest picture reach then.
const NARROWED: &str = r##"<script>
"use strict";
(async () => {
  const frame = document.querySelector("iframe"), wait = (ms) => new Promise((done) => setTimeout(done, ms));
  const inner = () => frame.contentDocument;
  while (!inner()?.documentElement?.dataset.drawn) await wait(20);
  frame.width = 400;
  const pictures = () => [...inner().querySelectorAll(".main-svg")].map((picture) => Math.ceil(picture.getBoundingClientRect().right));
  // The page draws again when its width has not changed for 150 ms.
  for (let tries = 0; tries < 200 && Math.max(...pictures()) > 400; tries++) await wait(20);
  const root = inner().documentElement;
  document.documentElement.dataset.narrowed = [root.scrollWidth - root.clientWidth, Math.max(...pictures())].join(" ");
})();
</script>"##;

#[test]
fn a_page_that_is_made_narrower_has_narrower_pictures() {
    let Some(browser) = chromium_for("a_page_that_is_made_narrower_has_narrower_pictures") else {
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let recording = simulated(dir.path(), "linear", 1);
    let out = dir.path().join("page.html");
    run(&["report", "-q", arg(&recording), "-o", arg(&out)]);
    let page = first_figure_only(&std::fs::read_to_string(&out).unwrap());
    let page = page.replace('&', "&amp;").replace('"', "&quot;");
    let frame = format!("<iframe width=\"900\" height=\"800\" srcdoc=\"{page}\"></iframe>");
    let around = dir.path().join("around.html");
    std::fs::write(
        &around,
        format!("<!DOCTYPE html><html><body>{frame}{NARROWED}</body></html>"),
    )
    .unwrap();
    let options = [
        "--dump-dom",
        "--virtual-time-budget=30000",
        "--window-size=1300,900",
    ];
    let (dom, _) = browse(browser, dir.path(), &around, &options);
    let narrowed: Vec<i32> = attribute(&dom, "narrowed")
        .split(' ')
        .map(|n| n.parse().unwrap_or(9999))
        .collect();
    let [overflow, right] = narrowed[..] else {
        panic!("{narrowed:?}");
    };
    assert!(overflow <= 0 && right <= 400, "{narrowed:?}");
}

/// Asks each page, once its first figure is there, how far down the parts of its first screen reach.
const FIRST_SCREENS: &str = r##"<script>
"use strict";
(async () => {
  for (const frame of document.querySelectorAll("iframe")) {
    const inner = () => frame.contentDocument;
    while (!inner()?.documentElement?.dataset.drawn) await new Promise((done) => setTimeout(done, 20));
    const bottom = (element) => element ? Math.ceil(element.getBoundingClientRect().bottom) : -1;
    const curves = inner().querySelectorAll("#answer g.trace").length;
    const parts = [...inner().querySelectorAll("#verdict"), inner().querySelector("#answer .main-svg"), inner().querySelector(".key")];
    frame.dataset.screen = [curves, inner().querySelectorAll(".key dd").length, ...parts.map(bottom)].join(" ");
  }
})();
</script>"##;

/// The page with its first figure alone: the others are below the first screen, and take their time.
fn first_figure_only(page: &str) -> String {
    let all = embedded(page, "figures");
    let start = "id=\"figures\">";
    let (before, rest) = page.split_once(start).unwrap();
    let (_, after) = rest.split_once("</script>").unwrap();
    let first = serde_json::json!([all[0]])
        .to_string()
        .replace('<', "\\u003c");
    format!("{before}{start}{first}</script>{after}")
}

/// A recording by another seed, to have two of a kind.
fn simulated(dir: &Path, servo: &str, seed: u64) -> PathBuf {
    let file = dir.join(format!("{servo}-{seed}.csv"));
    let port = format!("sim:{servo}?seed={seed}");
    run(&[
        "capture",
        "-q",
        "--port",
        &port,
        "--condition",
        "on the desk",
        "-o",
        arg(&file),
    ]);
    file
}

#[test]
fn the_first_screen_is_the_answer_on_a_desk_and_on_a_telephone() {
    let Some(browser) = chromium_for("the first screen of the report") else {
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let [linear, aircraft] = ["linear", "aircraft"].map(|servo| simulated(dir.path(), servo, 1));
    let stairs = data("dcmotor_position_stairs.csv");
    let withdrawn = data("model-schema-2-withdrawn.json");
    let other = dir.path().join("other.json");
    std::fs::copy(&withdrawn, &other).unwrap();
    let pages: [(&str, Vec<&str>); 4] = [
        ("one linear servo", vec![arg(&linear)]),
        (
            "a servo model",
            vec![
                arg(&stairs),
                "--servo-model",
                "--input",
                "u",
                "--output",
                "y",
            ],
        ),
        ("a comparison", vec![arg(&linear), arg(&aircraft)]),
        (
            "a comparison without bounds",
            vec![arg(&withdrawn), arg(&other)],
        ),
    ];
    let mut frames = String::from("<!DOCTYPE html><html><body>");
    for (_, files) in &pages {
        let out = dir.path().join("page.html");
        run(&[&["report", "-q", "--force", "-o", arg(&out)], &files[..]].concat());
        let page = first_figure_only(&std::fs::read_to_string(&out).unwrap());
        let page = page.replace('&', "&amp;").replace('"', "&quot;");
        for width in [1280, 400] {
            frames +=
                &format!("<iframe width=\"{width}\" height=\"800\" srcdoc=\"{page}\"></iframe>");
        }
    }
    let around = dir.path().join("around.html");
    std::fs::write(&around, frames + FIRST_SCREENS + "</body></html>").unwrap();
    let options = [
        "--dump-dom",
        "--virtual-time-budget=30000",
        "--window-size=1300,900",
    ];
    let (dom, _) = browse(browser, dir.path(), &around, &options);
    let mut seen = dom.split("data-screen=\"").skip(1);
    for (kind, _) in &pages {
        for width in [1280, 400] {
            let numbers = seen
                .next()
                .and_then(|rest| rest.split('"').next())
                .unwrap_or_default();
            let numbers: Vec<i32> = numbers
                .split(' ')
                .map(|n| n.parse().unwrap_or(-1))
                .collect();
            let [curves, figures, verdict, picture, key] = numbers[..] else {
                panic!("{kind}, {width}: {numbers:?}");
            };
            assert!(curves >= 1 && figures == 6, "{kind}, {width}: {numbers:?}");
            for bottom in [verdict, picture, key] {
                assert!((1..=800).contains(&bottom), "{kind}, {width}: {numbers:?}");
            }
        }
    }
}
