//! Moments alone, as collected live or loaded, give the model that the record gives.

use approx::assert_relative_eq;
use servoid_identification::{
    Frequencies, MomentStream, Moments, NoiseOrder, Options, Record, Settling, identify,
    identify_moments,
};
use servoid_test_support::plants::{Noise, PERIOD, Plant, random, simulate, staircase};

fn fixed() -> Options {
    Options {
        settling: Settling::Samples(100),
        frequencies: Frequencies::Count(31),
        noise_order: NoiseOrder::Order(2),
        ..Options::default()
    }
}

#[test]
fn a_live_collection_ends_with_the_model_of_the_record() {
    let input = staircase();
    let output = simulate(Plant::A, Noise::Ar2, &input, 1.0, &mut random(8));
    let record = Record::of_run(PERIOD, &input, &output)
        .unwrap()
        .with_sample_phase(0.0005);
    let mut stream = MomentStream::new(PERIOD, 102, 3).with_sample_phase(0.0005);
    let mut looked = 0;
    for (u, y) in input.chunks(10).zip(output.chunks(10)) {
        stream.push(u, y);
        // A live display looks now and then; early looks may find too little.
        if stream.moments().rows() % 1000 < 10 {
            looked += usize::from(identify_moments(&stream.moments(), &fixed()).is_ok());
        }
    }
    assert!(looked > 1, "{looked} looks gave a model");
    let text = serde_json::to_string(&stream.moments()).unwrap();
    let loaded: Moments = serde_json::from_str(&text).unwrap();
    let live = identify_moments(&loaded, &fixed()).unwrap().model;
    let whole = identify(&record, &fixed()).unwrap();
    for (a, b) in live.step.value.iter().zip(&whole.step.value) {
        assert_relative_eq!(a, b, epsilon = 1e-9);
    }
    let [live_bounds, whole_bounds] = [&live, &whole].map(|m| m.step.bounds.valid().unwrap());
    for (a, b) in live_bounds.sd.iter().zip(&whole_bounds.sd) {
        assert_relative_eq!(a, b, max_relative = 1e-6);
    }
    assert_eq!(live.sample_phase_s, 0.0005);
    assert_relative_eq!(
        live.metrics.t50_s.value.unwrap(),
        whole.metrics.t50_s.value.unwrap(),
        epsilon = 1e-9
    );
    assert_eq!(
        live.residuals.whiteness_p, None,
        "moments do not hold single errors"
    );
}
