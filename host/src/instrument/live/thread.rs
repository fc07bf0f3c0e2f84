//! Estimating beside the capture.

use super::{Estimator, LiveStep};
use servoid_identification::{Error, Options};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};

/// An order to the thread.
enum Order {
    BeginRun,
    Samples(Vec<f64>, Vec<f64>),
    /// Estimate; where a percentage is given and seems to be reached, make sure of it. The answer
    /// goes to whoever waits for it.
    Estimate(Option<f64>, Option<Sender<()>>),
    /// Estimate from all samples, with every test of the residuals, and answer.
    EstimateAnew(Sender<()>),
}

/// The newest estimate, for anybody to look at.
#[derive(Default)]
struct LatestEstimate {
    latest: Mutex<Option<Arc<LiveStep>>>,
    busy: AtomicBool,
}

impl LatestEstimate {
    /// An estimate that fails leaves the one before.
    fn keep(&self, step: Result<LiveStep, Error>) {
        if let Ok(step) = step {
            let mut latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
            *latest = Some(Arc::new(step));
        }
    }
}

/// An [`Estimator`] on a thread of its own. Handing it samples never waits.
///
/// The thread ends when this is dropped and all requests are done.
pub struct LiveIdentification {
    orders: Sender<Order>,
    found: Arc<LatestEstimate>,
    until_percent: Option<f64>,
}

impl LiveIdentification {
    /// Without samples; they will be `period_s` seconds apart. Where the band is to be within
    /// `until_percent`, an estimate that seems to be is made anew from all samples before it is believed.
    pub fn new(period_s: f64, options: Options, until_percent: Option<f64>) -> Self {
        let (orders, queue) = channel();
        let found = Arc::new(LatestEstimate::default());
        let theirs = Arc::clone(&found);
        let estimator = Estimator::new(period_s, options);
        std::thread::spawn(move || work(&queue, estimator, &theirs));
        Self {
            orders,
            found,
            until_percent,
        }
    }

    /// Another run begins.
    pub fn begin_run(&self) {
        self.send(Order::BeginRun);
    }

    /// Adds consecutive samples of the run, NaN where one is missing.
    pub fn push(&self, input: Vec<f64>, output: Vec<f64>) {
        self.send(Order::Samples(input, output));
    }

    /// Has an estimate made, unless one is being made already.
    pub fn ask(&self) {
        if !self.found.busy.swap(true, Ordering::SeqCst) {
            self.send(Order::Estimate(self.until_percent, None));
        }
    }

    /// Has an estimate made of all samples so far, and waits for it.
    pub fn ask_and_wait(&self) {
        self.wait_for(|answer| Order::Estimate(self.until_percent, Some(answer)));
    }

    /// As [`LiveIdentification::ask_and_wait`], with what only the samples themselves show: whether the errors
    /// are noise. For the end of a run; it takes as long as `servoid identify`.
    pub fn ask_anew_and_wait(&self) {
        self.wait_for(Order::EstimateAnew);
    }

    fn wait_for(&self, order: impl FnOnce(Sender<()>) -> Order) {
        let (answer, done) = channel();
        self.send(order(answer));
        // A thread that is gone answers by being gone.
        let _nothing_more_comes = done.recv();
    }

    /// The newest estimate.
    pub fn latest(&self) -> Option<Arc<LiveStep>> {
        let latest = self.found.latest.lock();
        latest.unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The newest estimate, if its band is as narrow as was wanted.
    pub fn enough(&self) -> Option<Arc<LiveStep>> {
        let wanted = self.until_percent?;
        self.latest().filter(|step| step.is_within(wanted))
    }

    fn send(&self, order: Order) {
        // A thread that is gone leaves a capture without its estimates, which is no reason to end it.
        let _nobody_listens = self.orders.send(order);
    }
}

fn work(queue: &Receiver<Order>, mut estimator: Estimator, found: &LatestEstimate) {
    for order in queue {
        match order {
            Order::BeginRun => estimator.begin_run(),
            Order::Samples(input, output) => estimator.push(&input, &output),
            Order::Estimate(wanted, answer) => {
                let mut step = estimator.estimate();
                if let (Ok(found), Some(percent)) = (&step, wanted)
                    && found.is_within(percent)
                {
                    step = estimator.estimate_anew();
                }
                found.keep(step);
                found.busy.store(false, Ordering::SeqCst);
                drop(answer);
            }
            Order::EstimateAnew(answer) => {
                found.keep(estimator.estimate_anew());
                drop(answer);
            }
        }
    }
}
