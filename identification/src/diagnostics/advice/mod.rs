//! The sentences of advice: findings, and what to do about each.
//!
//! A finding on a model without bounds does not speak of bounds, nor has it a number that is the width of one.

mod command;
mod disturbances;
mod errors;
mod evidence;
mod excitation;
mod record;
mod resolution;
mod response;
mod strokes;
mod time_fault;

pub(crate) use crate::diagnostics::advice::evidence::Evidence;

use crate::results::Advice;

/// All findings on a model. That the servo stops, changes, or is slower than the record shows, or that times are not what they seem, stands alone:
/// whatever else is found may be its consequence.
pub(crate) fn gather_advice(evidence: &Evidence<'_>) -> Vec<Advice> {
    if let Some(stopped) = response::servo_stopped(evidence) {
        return vec![stopped];
    }
    if let Some(fault) = time_fault::time_fault(evidence) {
        return vec![fault];
    }
    if let Some(slow) = response::slow_servo(evidence) {
        return vec![slow];
    }
    if let Some(drift) = response::gain_drift(evidence) {
        return vec![drift];
    }
    [
        excitation::output_leads(evidence),
        excitation::feedback(evidence),
        response::travel_end(evidence, 0),
        response::travel_end(evidence, 1),
        response::still_rising(evidence),
        excitation::excitation(evidence),
        errors::model_error(evidence),
        errors::not_linear(evidence),
        strokes::other_strokes(evidence),
        excitation::left_out(evidence),
        excitation::smooth(evidence),
        errors::metrics(evidence),
        errors::gain_may_be_zero(evidence),
        excitation::metrics(evidence),
        response::settled(evidence),
        response::slow_end(evidence),
        response::repeats(evidence),
        response::hidden_tail(evidence),
        response::responds(evidence),
        response::truncated(evidence),
        resolution::quantised(evidence),
        record::parameters(evidence),
        errors::slow_noise(evidence),
        errors::whiteness(evidence),
        errors::independence(evidence),
        record::conditioning(evidence),
        record::converged(evidence),
        disturbances::drift(evidence),
        disturbances::outliers(evidence),
        disturbances::hum(evidence),
        command::noise(evidence),
        record::scatter(evidence),
        record::deviating(evidence),
        record::history(evidence),
        record::at_rest(evidence),
        record::start(evidence),
    ]
    .into_iter()
    .flatten()
    .collect()
}

#[cfg(test)]
mod tests {
    use crate::results::{Check, Model};
    use crate::{Options, Record, Settling, identify};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    /// A lag of a few samples under random levels, whose noise remembers the share `memory` of its last value.
    fn model(samples: usize, memory: f64) -> Model {
        let mut random = ChaCha8Rng::seed_from_u64(11);
        let (mut level, mut servo, mut noise) = (1.0, 1.0, 0.0);
        let (mut input, mut output) = (Vec::new(), Vec::new());
        for _ in 0..samples {
            if random.random_bool(0.1) {
                level = -level;
            }
            noise = memory * noise + 0.02 * random.sample::<f64, _>(StandardNormal);
            servo += 0.3 * (level - servo);
            input.push(level);
            output.push(servo + noise);
        }
        let options = Options {
            settling: Settling::Samples(41),
            ..Options::default()
        };
        identify(&Record::of_run(0.01, &input, &output).unwrap(), &options).unwrap()
    }

    fn checks(model: &Model) -> Vec<&Check> {
        model.advice.iter().map(|found| &found.check).collect()
    }

    #[test]
    fn noise_that_drifts_is_slow_and_noise_that_forgets_is_not() {
        let slow = |model: &Model| {
            let found = model
                .advice
                .iter()
                .find(|found| found.check == Check::SlowNoise);
            found.map(|found| found.finding.clone())
        };
        let drift = slow(&model(4000, 0.995)).unwrap();
        assert!(drift.contains("drifts slowly"), "{drift}");
        let few = slow(&model(300, 0.95)).unwrap();
        assert!(few.contains("itself uncertain by"), "{few}");
        assert_eq!(slow(&model(4000, 0.5)), None);
    }

    #[test]
    fn metrics_that_are_left_out_for_a_gain_that_may_be_zero_have_advice() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let input: Vec<f64> = (0..400).map(|k| f64::from(k / 20 * 7 % 5 % 2)).collect();
        // A pulse after each change of the input, and no gain at rest.
        let output: Vec<f64> = (0..400)
            .map(|k: usize| {
                let noise = 0.05 * random.sample::<f64, _>(StandardNormal);
                input[k] - input[k.saturating_sub(5)] + noise
            })
            .collect();
        let options = Options {
            settling: Settling::Samples(15),
            ..Options::default()
        };
        let record = Record::of_run(0.01, &input, &output).unwrap();
        let model = identify(&record, &options).unwrap();
        assert_eq!(
            model.metrics.withheld,
            Some(crate::results::Withheld::GainMayBeZero)
        );
        assert!(checks(&model).contains(&&Check::GainMayBeZero));
    }

    #[test]
    fn a_short_record_has_many_parameters_and_loses_samples_to_history() {
        let short = model(160, 0.0);
        let found = checks(&short);
        assert!(
            found.contains(&&Check::Parameters) && found.contains(&&Check::History),
            "{found:?}"
        );
        let long = model(2000, 0.0);
        let found = checks(&long);
        assert!(
            !found.contains(&&Check::Parameters) && !found.contains(&&Check::History),
            "{found:?}"
        );
    }
}
