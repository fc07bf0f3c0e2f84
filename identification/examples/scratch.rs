//! scratch
use servoid_identification::servo_model::*;
use servoid_identification::*;
fn ticks() -> f64 {
    let s = std::fs::read_to_string("/proc/self/stat").unwrap();
    let f: Vec<&str> = s.rsplit(')').next().unwrap().split_whitespace().collect();
    f[11].parse::<f64>().unwrap() / 100.0
}
fn read(path: &str, only: Option<&str>) -> (f64, Vec<(String, String)>, Record) {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines().filter(|l| !l.starts_with('#'));
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let col = |n: &str| head.iter().position(|h| *h == n);
    let (t, u, y) = (col("t").unwrap(), col("u").unwrap(), col("y").unwrap());
    let (r, c) = (col("run"), col("kp"));
    let mut runs: Vec<(String, String, Vec<f64>, Vec<f64>)> = vec![];
    let mut times = vec![];
    for l in lines {
        let f: Vec<&str> = l.split(',').collect();
        let name = r.map_or("1", |i| f[i]).to_owned();
        if only.is_some_and(|o| !o.split('+').any(|x| x == name)) {
            continue;
        }
        if runs.last().is_none_or(|x| x.0 != name) {
            runs.push((name, c.map_or("", |i| f[i]).to_owned(), vec![], vec![]));
        }
        let last = runs.last_mut().unwrap();
        if times.len() < 2 {
            times.push(f[t].parse::<f64>().unwrap());
        }
        last.2.push(f[u].parse().unwrap_or(f64::NAN));
        last.3.push(f[y].parse().unwrap_or(f64::NAN));
    }
    let p = times[1] - times[0];
    let names = runs.iter().map(|r| (r.0.clone(), r.1.clone())).collect();
    (
        p,
        names,
        Record::new(
            p,
            runs.into_iter()
                .map(|r| Run::new(r.2, r.3).unwrap())
                .collect(),
        )
        .unwrap(),
    )
}
fn main() {
    let d = "/tmp/try/";
    for (name, ident, valid) in [
        ("miuzei", "odd.csv", vec!["even.csv"]),
        ("bam", "b1346.csv", vec!["b2.csv", "b5.csv"]),
        ("motor", "dm1.csv", vec!["dm2.csv"]),
        ("daisy", "h1.csv", vec!["h2.csv"]),
        ("aircraft", "pa1.csv", vec!["pa2.csv"]),
    ] {
        if std::env::args().nth(1).is_some_and(|a| a != name) {
            continue;
        }
        let (_, names, rec) = read(&(d.to_owned() + ident), None);
        let mut kinds: Vec<String> = vec![];
        let id = |k: &String, kinds: &mut Vec<String>| {
            if let Some(i) = kinds.iter().position(|x| x == k) {
                i
            } else {
                kinds.push(k.clone());
                kinds.len() - 1
            }
        };
        let controllers: Vec<usize> = names.iter().map(|n| id(&n.1, &mut kinds)).collect();
        let a = ticks();
        let servo = fit(
            &rec,
            &ServoModelOptions {
                controllers,
                ..Default::default()
            },
        )
        .unwrap();
        let b = ticks();
        print!(
            "{name} {} samples {:.2} s held {:.2} fit {:.2}",
            rec.samples(),
            b - a,
            servo.fit.held_out_percent,
            servo.fit.simulation_percent
        );
        let valid2 = valid.clone();
        for v in valid {
            let (_, n, rec) = read(&(d.to_owned() + v), None);
            let c: Vec<usize> = n.iter().map(|n| id(&n.1, &mut kinds)).collect();
            print!(
                "  {v} {:.2}",
                servo.validate(&rec, &c).map_or(f64::NAN, |v| v.fit_percent)
            );
        }
        println!(
            "  {:?} {} rungs, {} alternatives",
            servo.terms,
            servo.ladder.len(),
            servo.alternatives.len()
        );
        if std::env::var("PERTURB").is_ok() {
            let mut seed = 12345u64;
            let mut rnd = || {
                seed = seed
                    .wrapping_mul(6364136223846793005)
                    .wrapping_add(1442695040888963407);
                (seed >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
            };
            for size in [1e-4, 1e-3, 5e-3, 0.02] {
                print!("   {size}:");
                for _ in 0..10 {
                    let mut other = servo.clone();
                    for v in &mut other.values {
                        *v *= 1.0 + size * rnd();
                    }
                    for v in &valid2 {
                        let (_, n, rec) = read(&(d.to_owned() + v), None);
                        let c: Vec<usize> = n.iter().map(|n| id(&n.1, &mut kinds)).collect();
                        print!(
                            " {:.1}",
                            other.validate(&rec, &c).map_or(f64::NAN, |v| v.fit_percent)
                        );
                    }
                }
                println!();
            }
        }
        if std::env::var("QUANT").is_ok() {
            for (c, v) in servo.coordinates.iter().zip(&servo.values) {
                print!(" {c:?}={v:.5}");
            }
            println!();
        }
        if std::env::var("RUNGS").is_ok() {
            for r in &servo.ladder {
                println!(
                    "   {:.2} {:.2} {:?}",
                    r.held_out_percent, r.fit_percent, r.terms
                );
            }
        }
    }
}
