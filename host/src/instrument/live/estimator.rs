//! A step response of the samples so far.

use servoid_identification::results::StepResponse;
use servoid_identification::{
    Error, MomentStream, Options, Record, Run, Settling, identify, identify_moments,
};
use servoid_protocol::timing::SAMPLES_PER_FRAME;

/// The settling time is chosen anew when there are so many times the samples of the last choice: then
/// all choices together cost no more than a few times the last one, however long the run.
const CHOOSE_AGAIN: f64 = 1.25;

/// Samples that are kept for choosing the settling time anew: those of the longest run that a board can
/// make, 10 MB. Beyond them the settling time stays, and the moments go on.
const MOST_KEPT: usize = u16::MAX as usize * SAMPLES_PER_FRAME;

/// The largest order of noise that is looked for, as lags that the moments need beyond N.
const NOISE_LAGS: usize = 8;

/// A step response that was found in the middle of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct LiveStep {
    /// Samples that it is made of.
    pub samples: usize,
    /// The response, with its bounds where they hold.
    pub step: StepResponse,
}

impl LiveStep {
    /// Half of the width of the whole curve's band where it is widest, in percent of the commanded step; `None`
    /// where there is no band.
    pub fn half_width_percent(&self) -> Option<f64> {
        let bounds = self.step.bounds.valid()?;
        Some(100.0 * bounds.widest_half_width())
    }

    /// Whether the whole band is within ±`percent` of the commanded step.
    pub fn is_within(&self, percent: f64) -> bool {
        self.half_width_percent()
            .is_some_and(|half| half <= percent)
    }
}

/// Samples of one run or more, and step responses of them.
///
/// Choosing the settling time N costs a pass over all samples; with N fixed, moments that are kept up
/// to date give the step response at a cost that does not grow with the run. Memory is bounded too: N is
/// chosen among the samples of the longest run at most, 10 MB, and stays from then on.
///
/// ```
/// use servoid::instrument::live::Estimator;
/// use servoid_identification::Options;
/// let mut estimator = Estimator::new(0.002, Options::default());
/// assert!(estimator.estimate().is_err()); // no samples yet
/// # let (mut y, mut noise) = (0.0, 1u32);
/// for k in 0..1600 {
///     let u = if (k / 300) % 2 == 0 { 5.0 } else { -5.0 };
/// #   noise = noise.wrapping_mul(1664525).wrapping_add(1013904223);
/// #   y += 0.1 * (u - y);
/// #   let measured = y + 0.02 * (f64::from(noise >> 8) / f64::from(1 << 24) - 0.5);
///     estimator.push(&[u], &[measured]);
/// }
/// let step = estimator.estimate()?;
/// assert!(step.is_within(1.0), "{:?}", step.half_width_percent());
/// # Ok::<(), servoid_identification::Error>(())
/// ```
pub struct Estimator {
    period_s: f64,
    options: Options,
    /// Input and output run by run, until there are too many of them.
    runs: Option<Vec<(Vec<f64>, Vec<f64>)>>,
    most_kept: usize,
    samples: usize,
    /// Samples that there were when N was chosen.
    chosen_at: usize,
    /// N, and the moments for it.
    chosen: Option<(usize, MomentStream)>,
}

impl Estimator {
    /// Without samples; they will be `period_s` seconds apart.
    pub fn new(period_s: f64, options: Options) -> Self {
        Self {
            period_s,
            options,
            runs: Some(Vec::new()),
            most_kept: MOST_KEPT,
            samples: 0,
            chosen_at: 0,
            chosen: None,
        }
    }

    /// Another run begins, which does not depend on the samples before.
    pub fn begin_run(&mut self) {
        if let Some(runs) = &mut self.runs {
            runs.push((Vec::new(), Vec::new()));
        }
        if let Some((_, stream)) = &mut self.chosen {
            stream.begin_run(None);
        }
    }

    /// Adds consecutive samples of the run, NaN where one is missing. The input is what the servo got, and not rounded.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn push(&mut self, input: &[f64], output: &[f64]) {
        assert_eq!(input.len(), output.len(), "one output per input");
        if self.runs.is_some() && self.samples + input.len() > self.most_kept {
            self.let_go();
        }
        if let Some(runs) = &mut self.runs {
            if runs.is_empty() {
                runs.push((Vec::new(), Vec::new()));
            }
            if let Some((u, y)) = runs.last_mut() {
                u.extend(input);
                y.extend(output);
            }
        }
        self.samples += input.len();
        if let Some((_, stream)) = &mut self.chosen {
            stream.push(input, output);
        }
    }

    /// Chooses N a last time and lets go of the samples. Where they allow no choice, all begins anew
    /// with those that come.
    fn let_go(&mut self) {
        let _may_not_be_found = self.estimate_anew();
        if self.chosen.is_some() {
            self.runs = None;
        } else {
            self.runs = Some(Vec::new());
            self.samples = 0;
        }
    }

    /// The step response of the samples so far.
    ///
    /// # Errors
    /// One sentence that names what the samples lack; more of them may mend it.
    pub fn estimate(&mut self) -> Result<LiveStep, Error> {
        let again = self.samples as f64 >= CHOOSE_AGAIN * self.chosen_at as f64;
        match &self.chosen {
            Some((settling, stream)) if !again => self.of_moments(*settling, stream),
            _ => self.estimate_anew(),
        }
    }

    /// The step response that `servoid identify` gives of these samples: nothing is carried over from
    /// earlier estimates, as long as all samples are kept.
    pub fn estimate_anew(&mut self) -> Result<LiveStep, Error> {
        let all = match (&self.runs, &self.chosen) {
            (None, Some((settling, stream))) => return self.of_moments(*settling, stream),
            (runs, _) => runs.as_deref().unwrap_or_default(),
        };
        let runs = all.iter().filter(|(u, _)| !u.is_empty());
        let runs: Result<Vec<Run>, Error> = runs
            .map(|(u, y)| Run::new(u.clone(), y.clone()).map(Run::with_exact_input))
            .collect();
        let record = Record::new(self.period_s, runs?)?;
        let model = identify(&record, &self.options)?;
        let settling = model.structure.settling_samples;
        if self.chosen.as_ref().is_none_or(|(n, _)| *n != settling) {
            let (inputs, outputs) = (settling + NOISE_LAGS, NOISE_LAGS + 1);
            let mut stream = MomentStream::new(self.period_s, inputs, outputs);
            for (u, y) in all {
                stream.begin_run(None);
                stream.push(u, y);
            }
            self.chosen = Some((settling, stream));
        }
        self.chosen_at = self.samples;
        Ok(LiveStep {
            samples: self.samples,
            step: model.step,
        })
    }

    fn of_moments(&self, settling: usize, stream: &MomentStream) -> Result<LiveStep, Error> {
        let options = Options {
            settling: Settling::Samples(settling),
            ..self.options
        };
        let found = identify_moments(&stream.moments(), &options)?;
        Ok(LiveStep {
            samples: self.samples,
            step: found.model.step,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where the reference changes its sign: holds of 200, 150, 110 and 80 samples. Equal holds would
    /// be a periodic reference, which does not determine lags beyond a hold.
    const EDGES: [usize; 4] = [200, 350, 460, 540];

    /// A servo of first order (time constant 10 samples) with white noise of 0.05, between ±5.
    fn measure(samples: usize, seed: u64) -> (Vec<f64>, Vec<f64>) {
        use rand::{RngExt, SeedableRng};
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let mut y = 0.0;
        (0..samples)
            .map(|k| {
                let edges = EDGES.iter().filter(|edge| **edge <= k % EDGES[3]).count();
                let u = if edges % 2 == 0 { 5.0 } else { -5.0 };
                y += 0.095 * (u - y);
                // A uniform number has a variance of 1/12 of its width squared.
                let noise = 0.05 * 12f64.sqrt() * (random.random::<f64>() - 0.5);
                (u, y + noise)
            })
            .unzip()
    }

    /// The upper bounds of the whole curve.
    fn upper(step: &StepResponse) -> &[f64] {
        &step.bounds.valid().unwrap().simultaneous.upper
    }

    /// With an equal settling time moments and rows give the same; pieces do not matter.
    #[test]
    fn the_live_estimate_is_that_of_the_whole_record() {
        let (u, y) = measure(2400, 3);
        let mut live = Estimator::new(0.002, Options::default());
        for (u, y) in u[..2000].chunks(7).zip(y[..2000].chunks(7)) {
            live.push(u, y);
        }
        let first = live.estimate().unwrap();
        live.push(&u[2000..], &y[2000..]);
        let second = live.estimate().unwrap();
        assert_eq!((first.samples, second.samples), (2000, 2400));
        assert!(second.half_width_percent() < first.half_width_percent());
        let record = Record::of_run(0.002, &u, &y).unwrap();
        let options = Options {
            settling: Settling::Samples(first.step.value.len()),
            ..Options::default()
        };
        let whole = identify(&record, &options).unwrap();
        for (live, whole) in upper(&second.step).iter().zip(upper(&whole.step)) {
            // The alternation rests within 1e-3 of a standard deviation of its noise model, and may
            // come to rest from elsewhere.
            assert!((live - whole).abs() < 1e-4, "{live} {whole}");
        }
        let anew = live.estimate_anew().unwrap();
        let whole = identify(&record, &Options::default()).unwrap();
        assert_eq!(upper(&anew.step), upper(&whole.step));
    }

    #[test]
    fn a_long_run_is_let_go_of_and_estimated_all_the_same() {
        let (u, y) = measure(4_000, 5);
        let with_room_for = |most_kept: usize| {
            let mut live = Estimator {
                most_kept,
                ..Estimator::new(0.002, Options::default())
            };
            for (u, y) in u.chunks(10).zip(y.chunks(10)) {
                live.push(u, y);
                assert!(live.runs.iter().flatten().map(|r| r.0.len()).sum::<usize>() <= most_kept);
            }
            live
        };
        let mut short = with_room_for(2_000);
        assert!(short.runs.is_none());
        let step = short.estimate_anew().unwrap();
        assert_eq!(step.samples, 4_000);
        let settling = step.step.value.len();
        let options = Options {
            settling: Settling::Samples(settling),
            ..Options::default()
        };
        let record = Record::of_run(0.002, &u, &y).unwrap();
        let whole = identify(&record, &options).unwrap();
        for (live, whole) in upper(&step.step).iter().zip(upper(&whole.step)) {
            assert!((live - whole).abs() < 1e-4, "{live} {whole}");
        }
        // Too few samples for any choice at a time: nothing is found, and nothing piles up.
        let mut none = with_room_for(30);
        assert!(none.runs.is_some() && none.samples <= 30);
        assert!(none.estimate().is_err());
    }

    #[test]
    fn runs_add_up_and_are_not_joined() {
        let mut one = Estimator::new(0.002, Options::default());
        let mut three = Estimator::new(0.002, Options::default());
        for seed in 1..=3 {
            let (u, y) = measure(1500, seed);
            if seed == 1 {
                one.push(&u, &y);
            }
            three.begin_run();
            three.push(&u, &y);
        }
        let width = |live: &mut Estimator| live.estimate().unwrap().half_width_percent().unwrap();
        let ratio = width(&mut three) / width(&mut one);
        // Three times the rows: 1/√3 = 0.58. Another N may be chosen, and the slow end that bounds allow for is an estimate, or its deviation
        // where that is larger: in one run of the three it is as it comes.
        assert!((0.4..0.75).contains(&ratio), "{ratio}");
    }

    /// A sensor whose steps are larger than the noise reads the same again and again: no more of such
    /// samples narrow what its steps may hide.
    #[test]
    fn what_the_steps_of_the_sensor_may_hide_does_not_shrink() {
        const STEP: f64 = 0.5;
        let (u, y) = measure(2_400, 7);
        let y: Vec<f64> = y.iter().map(|y| (y / STEP).round() * STEP).collect();
        let mut live = Estimator::new(0.002, Options::default());
        live.push(&u, &y);
        let found = live.estimate_anew().unwrap();
        let record = Record::of_run(0.002, &u, &y).unwrap();
        let step = identify(&record, &Options::default()).unwrap().step;
        let bounds = step.bounds.valid().unwrap();
        assert!(bounds.rounding_bias > 0.0);
        assert_eq!(found.step.bounds.valid().unwrap().bias(), bounds.bias());
    }
}
