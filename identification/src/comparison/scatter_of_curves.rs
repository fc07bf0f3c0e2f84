//! By how much the curves of a few runs scatter, point by point.
//!
//! At a time at which what runs differ by passes zero, a few of them happen to lie close together, and their scatter there is that of nothing. So each deviation e_r of a run
//! from the mean g of all is divided into what a gain, a delay and another speed make of g, that is g, its slope and the slope times the time, made
//! independent of each other in this order, and what is left:
//!
//! ```text
//! e_r = sum_j q_rj b_j + rest_r,    variance = sum_j b_j² var q_j + var rest
//! ```
//!
//! It counts where that is more than the variance of the runs at the point.

use crate::numerics::dot;

/// A share of its square that a function must have beside those before it.
const OF_ITS_OWN: f64 = 1e-6;

/// The variance of a run at every point of the curves `of_runs`, each of which has `points` for each of its strokes.
pub(super) fn variances(of_runs: &[&[f64]], points: usize) -> Vec<f64> {
    let all = of_runs.first().map_or(0, |run| run.len());
    (0..all)
        .step_by(points)
        .flat_map(|start| {
            let stroke: Vec<&[f64]> = of_runs
                .iter()
                .map(|run| &run[start..start + points])
                .collect();
            of_stroke(&stroke)
        })
        .collect()
}

fn of_stroke(runs: &[&[f64]]) -> Vec<f64> {
    let count = runs.len() as f64;
    let points = runs[0].len();
    let mean: Vec<f64> = (0..points)
        .map(|m| runs.iter().map(|run| run[m]).sum::<f64>() / count)
        .collect();
    let deviation =
        |run: &&[f64]| -> Vec<f64> { run.iter().zip(&mean).map(|(y, g)| y - g).collect() };
    let deviations: Vec<Vec<f64>> = runs.iter().map(deviation).collect();
    let variance = |of: &[Vec<f64>], m: usize| {
        of.iter().map(|run| run[m] * run[m]).sum::<f64>() / (count - 1.0)
    };
    let functions = independent(changes(&mean));
    let mut rests = deviations.clone();
    let mut one_by_one = vec![0.0; points];
    for function in &functions {
        let mut square = 0.0;
        for (deviation, rest) in deviations.iter().zip(&mut rests) {
            let along = dot(deviation, function);
            square += along * along / (count - 1.0);
            rest.iter_mut()
                .zip(function)
                .for_each(|(rest, b)| *rest -= along * b);
        }
        one_by_one
            .iter_mut()
            .zip(function)
            .for_each(|(sum, b)| *sum += square * b * b);
    }
    (one_by_one.iter().enumerate())
        .map(|(m, sum)| (sum + variance(&rests, m)).max(variance(&deviations, m)))
        .collect()
}

/// What a gain, a delay and another speed change of a curve.
fn changes(mean: &[f64]) -> [Vec<f64>; 3] {
    let last = mean.len() - 1;
    let slope = |m: usize| (mean[(m + 1).min(last)] - mean[m.saturating_sub(1)]) / 2.0;
    let slopes: Vec<f64> = (0..mean.len()).map(slope).collect();
    let by_time = (0..).zip(&slopes).map(|(m, slope)| f64::from(m) * slope);
    let by_time = by_time.collect();
    [mean.to_vec(), slopes, by_time]
}

/// The functions, of unit length and independent of each other (Gram and Schmidt); without those that the ones before make.
fn independent(functions: [Vec<f64>; 3]) -> Vec<Vec<f64>> {
    let mut kept: Vec<Vec<f64>> = Vec::new();
    for function in functions {
        let whole = dot(&function, &function);
        let mut own = function;
        for before in &kept {
            let share = dot(&own, before);
            own.iter_mut()
                .zip(before)
                .for_each(|(x, b)| *x -= share * b);
        }
        let square = dot(&own, &own);
        if square > OF_ITS_OWN * whole {
            kept.push(own.iter().map(|x| x / square.sqrt()).collect());
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn where_curves_cross_they_scatter_as_what_they_differ_by() {
        // Slower runs that go farther: all are at .9 of the first at one time.
        let run = |gain: f64, lag: f64| -> Vec<f64> {
            (0..200)
                .map(|m| gain * (1.0 - (-f64::from(m) / lag).exp()))
                .collect()
        };
        let runs = [run(0.98, 19.0), run(1.0, 20.0), run(1.02, 21.0)];
        let runs: Vec<&[f64]> = runs.iter().map(Vec::as_slice).collect();
        let plain = |m: usize| {
            let values: Vec<f64> = runs.iter().map(|run| run[m]).collect();
            let mean = values.iter().sum::<f64>() / 3.0;
            values.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / 2.0
        };
        let found = variances(&runs, 200);
        let crossing = (20..150)
            .min_by(|a, b| plain(*a).total_cmp(&plain(*b)))
            .unwrap();
        let share = |m: usize| found[m].sqrt() / plain(m).sqrt();
        assert!(share(crossing) > 5.0, "{}", share(crossing));
        assert!((0..200).all(|m| found[m] >= plain(m)));
        // Where only one of the two differences is, it is what it was.
        assert!(share(199) < 1.05, "{}", share(199));
    }
}
