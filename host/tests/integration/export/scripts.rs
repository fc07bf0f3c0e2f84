//! The scripts, in Python, Octave and Julia.

use super::{SUBJECT, apart, export, largest_error, must, rows, trial, works};
use servoid_test_support::tools::{missing, skipped};
use std::fmt::Write;
use std::process::Command;

/// A list that Python, Octave and Julia read.
pub(super) fn literal(values: &[f64]) -> String {
    let mut text = String::from("[");
    for value in values {
        let _infallible = write!(text, "{value:?}, ");
    }
    text.truncate(text.len() - 2);
    text + "]"
}

/// The rows that every script prints: the trial's response, the step responses of the finite and of
/// the low-order model by the language's own control library where it has one, and the low-order
/// parameters' covariance.
fn check(printed: &str) {
    let rows = rows(printed);
    let (_, expected) = trial();
    let step = &SUBJECT.model.step.value;
    let last = step.len() - 1;
    // Sums of some hundred products in another order.
    assert!(apart(&rows[0], &expected) < 1e-9, "the finite response");
    assert!(apart(&rows[1], step) < 1e-9, "the step response");
    assert!(
        apart(&rows[2][..last], &step[..last]) <= largest_error(),
        "the low-order model"
    );
    let discrete = SUBJECT.flight.transfer.discrete(SUBJECT.model.timing());
    let exact = discrete.simulate(&vec![1.0; step.len()], 0.0);
    // As polynomials in z the close poles cost some six digits.
    assert!(apart(&rows[2], &exact) < 1e-7, "its discrete form");
    let flat: Vec<f64> = SUBJECT.flight.bounds.valid().unwrap().covariance.concat();
    assert_eq!(rows[3], flat, "its covariance");
    let variances: Vec<f64> = (0..=last.min(SUBJECT.model.theta.len() - 1))
        .map(|k| SUBJECT.model.bounds.valid().unwrap().covariance[k][k])
        .collect();
    assert_eq!(
        rows[4][..variances.len()],
        variances,
        "the covariance of theta"
    );
}

/// Stands for a package that is not there.
const NO_PACKAGE: &str = "function pkg(varargin)\nerror('the package is not there');\nend\n";

#[test]
fn the_script_without_a_control_package_says_what_to_install_and_has_the_rest() {
    if !works("octave-cli", &["--version"]) {
        return missing("the script in Octave", "there is no octave-cli");
    }
    let folder = tempfile::tempdir().unwrap();
    export("matlab", folder.path(), "servo_bench_1.m");
    std::fs::write(folder.path().join("pkg.m"), NO_PACKAGE).unwrap();
    let shown = "servo_bench_1; disp(lastwarn()); disp(servo_bench_1.order); disp(isfield(servo_bench_1, 'low_order'));";
    let mut octave = Command::new("octave-cli");
    octave.args(["-q", "--no-init-file", "--no-site-file", "--eval", shown]);
    let said = must(octave.current_dir(folder.path()));
    assert!(said.contains("pkg install -forge control"), "{said}");
    assert!(said.trim_end().ends_with('0'), "{said}");
}

const PYTHON: &str = r"
import sys
import numpy as np
sys.path.insert(0, sys.argv[1])
import servo_bench_1 as servo
show = lambda values: print(*(repr(float(v)) for v in np.ravel(values)))
ones = np.ones(len(servo.STEP))
assert 'linear model of a servo' in servo.__doc__
show(servo.simulate(TRIAL))
if servo.control is not None:
    import control
    times = servo.SAMPLE_PERIOD_S * np.arange(len(ones))
    finite = control.forced_response(servo.finite_response, times, ones).outputs
    low = control.forced_response(servo.low_order, times, ones).outputs
    gain = abs(servo.measured_frequency_response.eval(servo.OMEGA_RAD_S[7]))
    assert abs(gain - abs(servo.RESPONSE[7])) < 1e-12
    dc = control.dcgain(servo.low_order_without_delay)
    assert abs(dc - servo.GAIN) < 1e-12
else:
    finite, low = servo.simulate(ones), servo.simulate_low_order(ones)
assert np.allclose(low, servo.simulate_low_order(ones), atol=1e-7)
show(finite)
show(low)
show(servo.LOW_ORDER_COVARIANCE)
show(np.diag(servo.COVARIANCE))
assert np.allclose(servo.COVARIANCE, servo.COVARIANCE.T)
assert np.allclose(servo.simulate([2.0] * 9, before=2.0), 2.0 * servo.STEP[-1])
lead = servo.OMEGA_RAD_S * (servo.SAMPLE_PERIOD_S / 2 - servo.SAMPLE_PHASE_S)
turned = servo.RESPONSE * np.exp(1j * (lead - np.radians(servo.SERVO_PHASE_DEG)))
assert np.max(np.abs(np.angle(turned))) < 1e-9
assert np.all(servo.SERVO_PHASE_DEG_LOWER <= servo.SERVO_PHASE_DEG)
";

#[test]
fn the_python_module_gives_the_model_itself() {
    if !works("python3", &["-c", "import numpy"]) {
        return missing("the Python module", "there is no python3 with numpy");
    }
    if !works("python3", &["-c", "import control"]) {
        missing(
            "python-control's objects",
            "python-control is not installed",
        );
    }
    let folder = tempfile::tempdir().unwrap();
    export("python", folder.path(), "servo_bench_1.py");
    let script = PYTHON.replace("TRIAL", &literal(&trial().0));
    let python = Command::new("python3")
        .arg("-c")
        .arg(script)
        .arg(folder.path())
        .output();
    let python = python.unwrap();
    let errors = String::from_utf8_lossy(&python.stderr);
    assert!(python.status.success(), "{errors}");
    check(&String::from_utf8(python.stdout).unwrap());
}

const OCTAVE: &str = r"
servo_bench_1_script
servo = servo_bench_1;
show = @(values) printf('%s\n', strjoin(arrayfun(@(v) sprintf('%.17g', v), values, ...
    'UniformOutput', false), ' '));
times = servo.sample_period_s * (0:numel(servo.step) - 1)';
ones_in = ones(numel(times), 1);
show(servo.simulate(TRIAL));
show(lsim(servo.finite_response, ones_in, times)');
show(lsim(servo.low_order, ones_in, times)');
show(reshape(servo.low_order_covariance', 1, []));
show(diag(servo.covariance)');
assert(norm(servo.covariance - servo.covariance') == 0);
assert(abs(dcgain(servo.continuous) - servo.gain) < 1e-12);
[response, omega] = frdata(servo.frequency_response, 'vector');
assert(norm(response(:) - servo.response(:)) < 1e-12);
assert(norm(omega(:) - servo.omega_rad_s(:)) < 1e-12);
assert(strcmp(servo.name, 'bench 1'));
% At rest under a pulse of 1500 us until then: no step of 1500.
assert(max(abs(servo.simulate(1500 * ones(1, 9), 1500) - 1500 * servo.step(end))) < 1e-6);
assert(norm(servo.simulate(ones(1, 9)) - servo.simulate(ones(1, 9), 0)) == 0);
lead = servo.omega_rad_s * (servo.sample_period_s / 2 - servo.sample_phase_s);
turned = servo.response .* exp(1i * (lead - servo.servo_phase_deg * pi / 180));
assert(max(abs(angle(turned))) < 1e-9);
";

#[test]
fn the_matlab_script_gives_the_model_itself_in_octave() {
    let octave = ["--no-gui", "--norc", "--eval"];
    if !works(
        "octave-cli",
        &[&octave[1..], &["pkg load control"]].concat(),
    ) {
        return missing(
            "the MATLAB script",
            "there is no octave-cli with its package control",
        );
    }
    let folder = tempfile::tempdir().unwrap();
    export("matlab", folder.path(), "servo_bench_1_script.m");
    std::fs::write(
        folder.path().join("try.m"),
        OCTAVE.replace("TRIAL", &literal(&trial().0)),
    )
    .unwrap();
    let mut command = Command::new("octave-cli");
    command
        .args(["--norc", "--eval", "run_it"])
        .current_dir(folder.path());
    std::fs::rename(folder.path().join("try.m"), folder.path().join("run_it.m")).unwrap();
    check(&must(&mut command));
}

const JULIA: &str = r#"
include(joinpath(ARGS[1], "servo_bench_1.jl"))
servo = servo_bench_1
show_row(values) = println(join(repr.(vec(values)), " "))
unit = ones(length(servo.STEP))
show_row(servo.simulate(TRIAL))
show_row(servo.simulate(unit))
show_row(servo.simulate_low_order(unit))
show_row(permutedims(servo.LOW_ORDER_COVARIANCE))
show_row([servo.COVARIANCE[k, k] for k in axes(servo.COVARIANCE, 1)])
@assert abs(servo.low_order(0.0) - servo.GAIN) < 1e-12
@assert servo.NAME == "bench 1"
"#;

/// Parses a file of Julia.
pub(super) const JULIA_SYNTAX: &str = r"
import sys, tree_sitter, tree_sitter_julia
language = tree_sitter.Language(tree_sitter_julia.language())
tree = tree_sitter.Parser(language).parse(open(sys.argv[1], 'rb').read())
assert not tree.root_node.has_error, tree.root_node
print('parsed')
";

#[test]
fn the_julia_module_gives_the_model_itself_or_is_at_least_julia() {
    let folder = tempfile::tempdir().unwrap();
    let file = export("julia", folder.path(), "servo_bench_1.jl");
    if works("julia", &["--version"]) {
        let script = folder.path().join("try.jl");
        std::fs::write(&script, JULIA.replace("TRIAL", &literal(&trial().0))).unwrap();
        let mut julia = Command::new("julia");
        return check(&must(
            julia
                .arg("--startup-file=no")
                .arg(script)
                .arg(folder.path()),
        ));
    }
    if !works("python3", &["-c", "import tree_sitter, tree_sitter_julia"]) {
        let reason = "there is neither julia nor python3 with tree-sitter-julia";
        return missing("the Julia module", reason);
    }
    // No registry that the continuous integration may use has Julia.
    skipped(
        "running the Julia module",
        "there is no julia; its syntax is checked",
    );
    must(Command::new("python3").args(["-c", JULIA_SYNTAX]).arg(file));
}
