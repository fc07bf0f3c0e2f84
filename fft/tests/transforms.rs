//! Transforms and their inverses.

#[test]
fn the_inverse_gives_the_signal_back() {
    // Powers of two, and lengths with large factors.
    for size in [2048, 3600, 2 * 1009] {
        let signal: Vec<f64> = (0..size).map(|k| (k as f64 * 0.37).sin() + 0.5).collect();
        let forward = servoid_fft::forward(size);
        let mut spectrum = forward.make_output_vec();
        forward.process(&mut signal.clone(), &mut spectrum).unwrap();
        // The line at zero is the sum.
        assert!((spectrum[0].re - signal.iter().sum::<f64>()).abs() < 1e-8);
        let mut back = vec![0.0; size];
        servoid_fft::inverse(size)
            .process(&mut spectrum, &mut back)
            .unwrap();
        for (found, value) in back.iter().zip(&signal) {
            assert!((found / size as f64 - value).abs() < 1e-12);
        }
    }
}
