//! `servoid recover`

use super::output::Output;
use crate::data::recording::{
    Completeness, Recording, RecordingWriter, WholeFile, is_recording, recover,
};
use anyhow::{Context, Result, bail};
use clap::Args;
use std::path::PathBuf;

/// Save the sound frames of a damaged recording
///
/// Keeps every frame of ten rows that is consistent in itself, and lists the others as lost. Nothing is
/// guessed. The result is a partial recording.
#[derive(Debug, Args)]
#[command(after_help = "Example:
  servoid recover damaged.csv -o saved.csv")]
pub(super) struct Recover {
    /// The damaged recording
    #[arg(value_name = "REC.csv")]
    recording: PathBuf,
    /// The recording to write
    #[arg(long, short, value_name = "FILE.csv")]
    out: PathBuf,
    #[command(flatten)]
    output: Output,
}

impl Recover {
    pub(super) fn run(self) -> Result<String> {
        let path = &self.recording;
        let bytes = crate::data::input_file::read(path)
            .with_context(|| format!("{path:?} cannot be read"))?;
        if !is_recording(&bytes) {
            bail!("nothing to recover: {path:?} is no recording of servoid");
        }
        if let Ok(sound) = Recording::parse(&bytes, path) {
            if sound.rows.is_empty() {
                bail!("nothing to recover: {path:?} has no rows");
            }
            let rows = sound.rows.len();
            let state = match sound.completeness {
                Completeness::Complete => "is complete and undamaged".to_owned(),
                Completeness::Early(why) => {
                    format!("is undamaged, and was ended on purpose: {why}")
                }
                Completeness::Partial(why) => format!(
                    "is partial, as {why}. What is missing is not in the file; its {rows} rows are sound, and other commands read it as it is"
                ),
            };
            bail!("nothing to recover: {path:?} {state}");
        }
        let saved = recover(&bytes, path)?;
        let whole = WholeFile::new(&self.out, self.output.force)?;
        let file = Box::new(whole.file()?);
        saved.write(RecordingWriter::on(file, &self.out, &saved.header)?)?;
        whole.put_in_place()?;
        let talk = self.output.talk;
        saved.findings.iter().for_each(|finding| talk.say(finding));
        let lost_frames: Vec<_> = saved.lost_frames.iter().map(|f| [f.start, f.end]).collect();
        let lost: u32 = lost_frames.iter().map(|[start, end]| end - start).sum();
        let (out, rows) = (self.out.display(), saved.rows());
        let frames = if lost == 1 { "frame" } else { "frames" };
        let text = format!("{out}: partial, {rows} samples, {lost} {frames} lost\n");
        let result = serde_json::json!({
            "file": self.out,
            "rows": rows,
            "lost_frames": lost_frames,
            "findings": saved.findings,
        });
        talk.result(text, &result)
    }
}
