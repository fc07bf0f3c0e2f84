//! The moments of a whole record.

use super::{lagged::Moments, stream::MomentStream};
use crate::data::record::{Record, Run};

/// Up to this many rows, adding them one by one costs less than another pass over the data.
const ROWS_ADDED_SINGLY: usize = 500;

impl Moments {
    /// The moments of all runs of `record` for `input_lags` lags of the input and `output_lags`
    /// (at most as many) of the output. A model with settling time N and noise order d needs N+d
    /// and d+1.
    pub fn of_record(record: &Record, input_lags: usize, output_lags: usize) -> Self {
        let mut stream = MomentStream::new(record.sample_period_s(), input_lags, output_lags)
            .with_sample_phase(record.sample_phase_s());
        for run in record.runs() {
            stream.push_run(run);
        }
        stream.into_moments()
    }

    /// The moments of fewer input lags over all rows of `record` that are complete for them. The few rows
    /// that lack only the longer history are added one by one. If they are many, a new pass is made.
    pub(crate) fn with_fewer_lags(&self, record: &Record, input_lags: usize) -> Self {
        let outputs = self.output_lags();
        let gained: Vec<(&Run, usize)> = record
            .runs()
            .iter()
            .flat_map(|run| {
                let long = run.complete_rows(self.input_lags(), outputs);
                let mut long = long.into_iter().peekable();
                run.complete_rows(input_lags, outputs)
                    .into_iter()
                    .flat_map(move |span| {
                        // A stretch with long history ends where one with short history ends, and
                        // starts later.
                        let start = long.next_if(|long| long.end == span.end);
                        (span.start..start.map_or(span.end, |long| long.start))
                            .map(move |k| (run, k))
                    })
            })
            .collect();
        if gained.len() > ROWS_ADDED_SINGLY {
            return Self::of_record(record, input_lags, outputs);
        }
        let mut moments = self.truncated(input_lags, outputs);
        for (run, k) in gained {
            moments.add_row(run, k);
        }
        moments
    }
}
