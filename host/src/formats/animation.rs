// SPDX-License-Identifier: MIT OR Apache-2.0
//! Animated PNG.

use std::io;
use std::path::Path;

use super::picture::channels;
use super::whole::{WriteError, write_whole};
use png::{BitDepth, BlendOp, ColorType, DisposeOp, Encoder};

/// Writes an animated PNG that plays for ever, whole or not at all. `frames`: pictures as [`super::write_png`] takes them, all
/// with the same number of channels; they may be made while the file is written, and an error among them leaves no
/// file. `delay`: numerator and denominator of the seconds that each frame is shown.
///
/// # Errors
/// [`WriteError`]: also for no frames, and for a denominator of 0.
pub fn write_animation<F: AsRef<[u8]>>(
    path: impl AsRef<Path>,
    width: u32,
    height: u32,
    mut frames: impl ExactSizeIterator<Item = io::Result<F>>,
    delay: [u16; 2],
) -> Result<(), WriteError> {
    let path = path.as_ref();
    let refused = |reason: &str| WriteError::Data { path: path.to_owned(), reason: reason.to_owned() };
    let count =
        u32::try_from(frames.len()).map_err(|_| refused("an animation has 2^32 - 1 frames at most"))?;
    let Some(first) = frames.next() else {
        return Err(refused("an animation needs at least one frame"));
    };
    let [numerator, denominator] = delay;
    if denominator == 0 {
        return Err(refused("a frame is shown for a fraction of a second whose denominator is 0"));
    }
    let first = first.map_err(|source| WriteError::File { path: path.to_owned(), source })?;
    let length = first.as_ref().len();
    let color = match channels(path, width, height, length, &[1, 3, 4])? {
        1 => ColorType::Grayscale,
        3 => ColorType::Rgb,
        _ => ColorType::Rgba,
    };
    write_whole(path, |writer| {
        let mut encoder = Encoder::new(writer, width, height);
        encoder.set_color(color);
        encoder.set_depth(BitDepth::Eight);
        // Plays: 0 is for ever.
        encoder.set_animated(count, 0)?;
        encoder.set_frame_delay(numerator, denominator)?;
        encoder.set_blend_op(BlendOp::Source)?;
        encoder.set_dispose_op(DisposeOp::None)?;
        // A frame more or less than was said would make a broken file.
        encoder.validate_sequence(true);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(first.as_ref())?;
        for frame in frames {
            writer.write_image_data(frame?.as_ref())?;
        }
        writer.finish()?;
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::File;
    use std::io::BufReader;

    /// The frames of a file, its number of plays, and the delay of each frame.
    fn read(path: &Path) -> (Vec<Vec<u8>>, u32, Vec<[u16; 2]>) {
        let file = BufReader::new(File::open(path).expect("written"));
        let mut reader = png::Decoder::new(file).read_info().expect("a picture");
        let control = *reader.info().animation_control().expect("an animation");
        let (mut frames, mut delays) = (Vec::new(), Vec::new());
        for _ in 0..control.num_frames {
            let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
            let shape = reader.next_frame(&mut pixels).expect("a frame");
            assert_eq!((shape.width, shape.height), (3, 2));
            pixels.truncate(shape.buffer_size());
            frames.push(pixels);
            let frame = reader.info().frame_control().expect("its control");
            delays.push([frame.delay_num, frame.delay_den]);
        }
        assert!(reader.next_frame(&mut [0; 24]).is_err(), "more frames than were said");
        (frames, control.num_plays, delays)
    }

    #[test]
    fn animations_come_back() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a.png");
        for channels in [1, 3, 4] {
            for count in [1, 5] {
                let frame = |number: u8| (0..3 * 2 * channels).map(|i| i * 7 + number * 20).collect();
                let frames: Vec<Vec<u8>> = (0..count).map(frame).collect();
                write_animation(&path, 3, 2, frames.iter().map(Ok), [1, 24]).expect("written");
                let found = read(&path);
                assert_eq!(found, (frames.clone(), 0, vec![[1, 24]; frames.len()]), "{channels} channels");
                // Where animations are not known the first frame is shown.
                assert_eq!(image::open(&path).expect("a picture").as_bytes(), frames[0]);
            }
        }
    }

    #[test]
    fn what_cannot_be_written_leaves_no_file() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a.png");
        let refused = |frames: Vec<io::Result<Vec<u8>>>, delay| {
            let error = write_animation(&path, 3, 2, frames.into_iter(), delay).expect_err("refused");
            assert_eq!(std::fs::read_dir(folder.path()).expect("the folder").count(), 0, "{error}");
            error.to_string()
        };
        let fine = || Ok(vec![0; 18]);
        assert!(refused(vec![], [1, 24]).contains("at least one frame"));
        assert!(refused(vec![fine()], [1, 0]).contains("denominator"));
        assert!(refused(vec![Ok(vec![0; 17])], [1, 24]).contains("3x2"));
        assert!(refused(vec![fine(), Ok(vec![0; 24])], [1, 24]).contains("a.png"));
        let drawn = || Err(io::Error::other("out of ink"));
        assert!(refused(vec![fine(), drawn()], [1, 24]).contains("out of ink"));
        assert!(refused(vec![drawn()], [1, 24]).contains("out of ink"));
    }
}
