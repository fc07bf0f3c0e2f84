//! Experiment.
use servoid_identification::{Options, identify_explained};
use servoid_test_support::closed_loop::{Course, Loop};
use servoid_test_support::plants::{Noise, Plant, random};
fn main() {
    let runs: usize = std::env::args().nth(1).map_or(10, |n| n.parse().unwrap());
    let only_open = std::env::args().nth(2);
    let options = Options { longest_settling: Some(301), ..Options::default() };
    let plant = Plant::A;
    for course in [Course::Staircase, Course::Telegraph, Course::Prbs, Course::Multisine] {
        for noise in [Noise::White, Noise::Ar1, Noise::Ar2] {
          for (controller, scale, delay) in [(None, 1.0, 0), (Some(0.3), 1.0, 0), (Some(0.3), 1.0, 1), (Some(0.3), 10.0, 0), (Some(0.3), 3.0, 0), (Some(0.3), 3.0, 1), (Some(0.3), 10.0,1), (Some(0.3), 10.0, 5)] {
            if only_open.as_deref() == Some("open") && controller.is_some() { continue; }
            if only_open.as_deref() == Some("closed") && controller.is_none() { continue; }
            let case = Loop { course, controller, plant, noise, scale, delay };
            let mut line = String::new();
            let (mut withdrawn, mut inside, mut p4, mut p2, mut against) = (0, 0, 0, 0, 0);
            let mut reasons = std::collections::BTreeMap::new();
            let mut ps = vec![]; let mut evident: Vec<String> = vec![];
            for run in 0..runs {
                let trial = case.trial(&mut random(1000 * run as u64 + 7));
                match identify_explained(&trial.record, &options) {
                    Err(e) => { *reasons.entry(e.to_string()).or_insert(0) += 1; withdrawn += 1; }
                    Ok(found) => {
                        if let Some(f) = found.explanation.feedback { p4 += usize::from(f.p < 1e-4); p2 += usize::from(f.p < 1e-2); against += usize::from(f.at_once < -4.0); ps.push((f.at_once, f.share)); if found.model.bounds.withdrawn().is_some_and(|r| format!("{r:?}") == "ErrorsNotNoise") { evident.push(format!("{:.0} {:.2}", f.at_once, f.share)); } }
                        match found.model.step.bounds.valid() {
                            None => { withdrawn += 1; *reasons.entry(format!("{:?}", found.model.bounds.withdrawn().unwrap())).or_insert(0) += 1; }
                            Some(b) => { let ok = b.simultaneous.lower.iter().zip(&b.simultaneous.upper).zip(&trial.truth).all(|((l,u),t)| l <= t && t <= u); inside += usize::from(ok); }
                        }
                    }
                }
            }
            line += &format!("{} | withdrawn {withdrawn} inside {inside} outside {} | p<1e-4 {p4} p<.01 {p2} against {against} {reasons:?} {evident:?}", case.label(), runs - withdrawn - inside);
            if controller.is_some() && runs - withdrawn - inside > 0 { line += &format!(" {:?}", ps.iter().take(3).map(|(p,a)| format!("{p:.0e} {a:.1}")).collect::<Vec<_>>()); }
            println!("{line}");
          }
        }
    }
}
