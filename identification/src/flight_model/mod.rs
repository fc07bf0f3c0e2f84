//! A low-order model for a flight simulation: gain, delay and one to three poles.
//!
//! The parameters x minimise (θ - m(x))'C^-1(θ - m(x)). θ is the estimate and C its covariance. m(x) is the
//! estimate that the same estimator would make of a servo with these parameters: its exact, continuous
//! response to the held command at the sample times, projected like the data (after P. J. Gawthrop & L.
//! Wang, "Data compression for estimation of the physical parameters of stable and unstable linear
//! systems", Automatica 2005, but with the projection instead of the plain frequency response, which would
//! make the delay half a sample too long).
//!
//! The order is the lowest whose χ² + dim x · ln(rank) is within 2 of the smallest. Its intervals hold servos of
//! up to three poles, because an order that is not needed is not known to be wrong. If the data reject the order,
//! as they do for every nonlinear servo, the model is an approximation without intervals: nothing shows how far its
//! parameters are from those of the servo. The largest error is stated, and the order is the lowest whose largest
//! error is within the limit in the options.
//!
//! The delay counts from the edge of the command as applied. A pulse width is applied at frame edges: a
//! simulation is [sample and hold at the frame period] -> [this model]. Without the hold it needs another
//! half frame of delay, and it lacks the jitter of up to a frame.
//!
//! Where the input excites a band alone, θ are the directions of all lags that the record determines `in_band`. Below and above the band, the order is assumed.

mod discrete;
mod estimates;
mod fitter;
mod identified_response;
mod in_band;
mod intervals;
mod levenberg_marquardt;
mod low_order;
mod model;
mod options;
mod order;
mod poles;
mod profile;
mod projection;
mod report;
mod runs_apart;
mod slow_end;
mod starting_points;

use crate::data::Record;
use crate::diagnostics::without_offsets_and_trends;
use crate::error::Error;
use crate::results::{Model, Reason};
use crate::thresholds::RUNS_FOR_MEAN;
use fitter::{FittedOrder, Fitter};
use order::simplest;
use projection::Projection;
use report::Circumstances;
use runs_apart::{Runs, RunsApart};
use starting_points::Guess;
use std::borrow::Cow;

pub use discrete::Discrete;
pub use low_order::{LowOrder, Oscillator};
pub use model::FlightModel;
pub use options::FlightModelOptions;
pub use order::OrderTried;

/// Fits `model`, identified from `record`, by a transfer function of low order.
///
/// ```
/// use servoid_identification::flight_model::{self, FlightModelOptions};
/// use servoid_identification::{identify, Options, Record, Settling};
/// // 10 ms of delay and a lag of 20 ms.
/// let servo = flight_model::LowOrder { gain: 0.9, delay_s: 0.01, oscillator: None, lag_s: Some(0.02) };
/// let u: Vec<f64> = (0..3000).map(|k| if k * k / 9000 % 2 == 0 { 5.0 } else { -5.0 }).collect();
/// let edges: Vec<usize> = (1..3000).filter(|&k| u[k] != u[k - 1]).collect();
/// let y: Vec<f64> = (0..3000).map(|k| {
///     let past = edges.iter().filter(|&&e| e <= k);
///     let noise = 0.01 * ((k * 7919 % 101) as f64 - 50.0) / 50.0;
///     4.5 + noise + past.map(|&e| (u[e] - u[e - 1]) * servo.step(0.002 * (k - e) as f64)).sum::<f64>()
/// }).collect();
/// let record = Record::of_run(0.002, &u, &y)?;
/// let options = Options { settling: Settling::Samples(101), ..Options::default() };
/// let model = identify(&record, &options)?;
/// let flight = flight_model::fit(&record, &model, &FlightModelOptions::default())?;
/// assert_eq!(flight.order, 1);
/// assert!((flight.transfer.delay_s - 0.01).abs() < 2e-4);
/// # Ok::<(), servoid_identification::Error>(())
/// ```
///
/// # Errors
/// The model has no response or no supported gain, part of its response is not known, or the record is not the one it was identified from; or it has bounds in a band alone, and does not say how they were
/// estimated.
pub fn fit(
    record: &Record,
    model: &Model,
    options: &FlightModelOptions,
) -> Result<FlightModel, Error> {
    let record = &without_runs_own(record, model);
    let of = |record: &Record<'_>, run: Option<usize>| match (model.band(), &model.band_estimate) {
        (Some(_), Some(estimate)) => in_band::in_band(record, model, &estimate.of_run(run)),
        (Some(_), None) => Err(Error::OfBandAlone),
        (None, _) => Projection::of_record(record, model),
    };
    let runs = match record.runs().len() >= RUNS_FOR_MEAN {
        false => Runs::TooFew,
        true => {
            let each = record.each_run().zip(0..);
            let each = each.map(|(alone, run)| of(&alone, Some(run)).ok());
            // One that is too short to show a response leaves how they differ to the bounds of the model.
            let each: Option<Vec<Projection>> = each.collect();
            each.map_or(Runs::Unknown, Runs::Each)
        }
    };
    choose(of(record, None)?, runs, model, options)
}

/// `record` without the offset and the drift of each run by which `model` was identified.
fn without_runs_own<'a>(record: &Record<'a>, model: &Model) -> Record<'a> {
    let period = record.sample_period_s();
    let slopes: Vec<f64> = (model.run_slopes.iter())
        .map(|slope| slope * period)
        .collect();
    without_offsets_and_trends(record, &model.run_offsets, &slopes)
}

/// [`fit`] without the record, from θ and its covariance alone.
///
/// The effect of a response longer than N samples, or with more detail than n frequencies, on the estimate
/// is then unknown. The bank is taken as a response that is over after N samples. With the structure chosen
/// from the data (n = N, and N 1.75 times the settling) the two agree. Of a servo that is not linear there are no intervals. With a short or small bank only
/// [`fit`] is right.
///
/// ```
/// # use servoid_identification::{identify, Options, Record, Settling};
/// # let u: Vec<f64> = (0..3000).map(|k| if k * k / 9000 % 2 == 0 { 5.0 } else { -5.0 }).collect();
/// # let y: Vec<f64> = u.iter().enumerate().scan(0.0, |y, (k, u)| {
/// #     *y += 0.1 * (u - *y); Some(*y + 0.01 * ((k * 7919 % 101) as f64 - 50.0) / 50.0)
/// # }).collect();
/// # let options = Options { settling: Settling::Samples(101), ..Options::default() };
/// use servoid_identification::flight_model::{self, FlightModelOptions};
/// let model = identify(&Record::of_run(0.002, &u, &y)?, &options)?;
/// let flight = flight_model::of_model(&model, &FlightModelOptions::default())?;
/// // A tenth of the way in each sample: a lag of 2 ms / -ln 0.9.
/// assert!((flight.transfer.lag_s.unwrap() - 0.019).abs() < 2e-4);
/// # Ok::<(), servoid_identification::Error>(())
/// ```
///
/// # Errors
/// The model has no response, no supported gain, or no covariance; or part of its response is not known; or it has bounds in a band alone.
pub fn of_model(model: &Model, options: &FlightModelOptions) -> Result<FlightModel, Error> {
    match model.band() {
        Some(_) => Err(Error::OfBandAlone),
        None => choose(
            Projection::of_model(model)?,
            Runs::Unknown,
            &without_bounds_of_motion(model),
            options,
        ),
    }
}

/// The model, without bounds where the servo is not linear: those of its description are wide enough to hide that an order is rejected by the recording, which alone says so.
fn without_bounds_of_motion(model: &Model) -> Cow<'_, Model> {
    match model.linear {
        true => Cow::Borrowed(model),
        false => Cow::Owned(model.clone().withdrawn_for(Reason::ErrorsNotNoise)),
    }
}

/// Fits every order and takes the one that the rule above says.
/// Lack of fit is tested where the bounds of the model hold, so that its noise is known; else an order is good by
/// its largest error alone.
fn choose(
    projection: Projection,
    runs: Runs,
    model: &Model,
    options: &FlightModelOptions,
) -> Result<FlightModel, Error> {
    let fitter = Fitter {
        projection,
        timing: model.timing(),
    };
    let band_hz = model.band_hz();
    let level = model.frequency.bounds.as_ref().map(|bounds| bounds.level);
    let is_tested = level.valid().is_some();
    if let Some(reason) = level
        .withdrawn()
        .filter(|reason| reason.leaves_response_open())
    {
        return Err(Error::ResponseOpen(reason.because()));
    }
    // A withheld gain must not return as a parameter, but as one that an order in a band makes of it.
    if band_hz.is_none() && model.metrics.dc_gain.value.is_none() {
        return Err(Error::Unexcited);
    }
    let guess = match band_hz {
        Some(_) => Guess::in_band(model),
        None => Guess::new(model),
    };
    let guess = guess.ok_or(Error::NoResponse)?;
    let mut fits: Vec<FittedOrder> = Vec::new();
    for order in 1..=3 {
        let found = |order: usize| fits.iter().find(|fit| fit.order == order);
        let [first, second] = [1, 2].map(|order| found(order).map(|fit| fit.transfer));
        let best = fitter.best(order, &guess.starts(order, first, second));
        fits.extend(best);
    }
    let not_rejected = |fit: &&FittedOrder| is_tested && !fit.tried.is_rejected();
    let chosen = match simplest(&fits, |fit| fit.tried).find(not_rejected) {
        None if fits.is_empty() => return Err(Error::NoResponse),
        Some(simplest) => simplest,
        None => {
            let good = |fit: &&FittedOrder| {
                fit.tried.largest_error_percent <= options.largest_error_percent
            };
            // A pole that does not show makes the order below: the lowest one stays in any case.
            let shown: Vec<_> = (fits.iter().enumerate())
                .filter(|(k, fit)| *k == 0 || !fit.has_hidden_pole(model.sample_period_s))
                .map(|(_, fit)| fit)
                .collect();
            let closest = shown.last().copied();
            let found = shown.into_iter().find(good).or(closest);
            found.ok_or(Error::NoResponse)?
        }
    };
    let circumstances = Circumstances {
        level,
        runs: RunsApart::of(runs, chosen, (&fitter.projection, model)),
        beyond_even_noise: fitter.projection.beyond_even_noise(model),
        band_hz,
        is_of_motion: !model.linear && band_hz.is_none(),
        gain: (model.metrics.dc_gain.value).filter(|_| band_hz.is_none()),
        hold_period_s: options.frame_period_s,
    };
    Ok(report::of(&fitter, chosen, &fits, &circumstances))
}
