"""Films of the motion: the frames, what they show, and what is refused."""

import numpy as np
import pytest
from PIL import Image

from vines import viewer
from vines.errors import ParameterError, ViewerError
from vines.logs import read
from vines.viewer import _video


def test_a_film_has_its_frames_and_the_ball_moves(settled, tmp_path):
    out = viewer.video(settled, tmp_path / "run.gif", periods=0.5, fps=4, size=(321, 240))
    with Image.open(out) as film:
        assert (getattr(film, "n_frames", 1), film.size) == (4, (322, 240))
        first = np.asarray(film.convert("RGB")).astype(int)
        film.seek(2)
        later = np.asarray(film.convert("RGB")).astype(int)
    assert np.abs(first - later).max() > 100
    assert first[0, 0].tolist() == later[0, 0].tolist() == [255, 255, 255]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run.gif"]


def test_times_end_with_the_run(settled):
    log = read(settled)
    times = _video._times(log, 2.0, 25)
    assert len(times) == 100
    np.testing.assert_allclose(log.states["t"].to_numpy()[-1] - times[-1], 2 * np.pi / 50)
    np.testing.assert_allclose(np.diff(times), 2 * np.pi / 50)


def test_what_cannot_be_is_refused(settled, empty, tmp_path, monkeypatch):
    with pytest.raises(ViewerError, match=r"does not end in .mp4 or .gif"):
        viewer.video(settled, tmp_path / "run.avi")
    with pytest.raises(ViewerError, match="no states of a ball"):
        viewer.video(empty, tmp_path / "run.gif")
    with pytest.raises(ParameterError, match="periods is 11, allowed is more than 0 and up to 10"):
        viewer.video(settled, tmp_path / "run.gif", periods=11)
    with pytest.raises(ParameterError, match=r"fps is 0, allowed is 1 to 50 of a \.gif"):
        viewer.video(settled, tmp_path / "run.gif", fps=0)
    monkeypatch.setattr(_video.shutil, "which", lambda name: None)
    with pytest.raises(ViewerError, match=r"needs the program ffmpeg.*name a .gif"):
        viewer.video(settled, tmp_path / "run.mp4")
    assert not list(tmp_path.iterdir())


def test_frames_are_written_as_they_are_drawn(settled, tmp_path, monkeypatch):
    sizes, frames = [], _video._frames

    def watched(*given):
        for frame in frames(*given):
            yield frame
            sizes.append(sum(path.stat().st_size for path in tmp_path.glob(".*.part")))

    monkeypatch.setattr(_video, "_frames", watched)
    viewer.video(settled, tmp_path / "run.gif", periods=1.0, fps=12, size=(640, 480))
    assert sizes[-1] > sizes[8] > 0


def test_ffmpeg_is_given_frames_one_by_one_and_its_last_words_are_told(settled, tmp_path, monkeypatch):
    program = tmp_path / "ffmpeg"
    program.write_text('#!/bin/sh\nfor last; do :; done\ncat > "$last"\n')
    program.chmod(0o755)
    monkeypatch.setattr(_video.shutil, "which", lambda name: str(program))
    made = viewer.video(settled, tmp_path / "run.mp4", periods=0.5, fps=4, size=(320, 240))
    frames = np.frombuffer(made.read_bytes(), np.uint8).reshape(4, 240, 320, 3)
    assert (frames[0] != frames[2]).any()
    program.write_text("#!/bin/sh\nhead -c 100 > /dev/null\necho no room >&2\nexit 1\n")
    with pytest.raises(ViewerError, match=r"ffmpeg ended with status 1: no room; a \.gif needs no ffmpeg"):
        viewer.video(settled, tmp_path / "run.mp4", periods=2.0, fps=4, size=(640, 480))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["ffmpeg", "run.mp4"]
