"""A film of the motion, drawn by matplotlib: cavity and ball to scale, and the gap over time. No viewer is needed."""

from __future__ import annotations

import contextlib
import io
import math
import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from vines.errors import ParameterError, ViewerError
from vines.logs import Log, read
from vines.packages import need
from vines.viewer._save import replacing

if TYPE_CHECKING:
    from PIL import Image

__all__ = ["FORMATS", "SECONDS_PER_CYCLE", "video"]

FORMATS = (".mp4", ".gif")
"""How names of films end."""
SECONDS_PER_CYCLE = 2.0
"""Seconds that a forcing cycle lasts in a film."""
_MOST_FRAMES = 5_000
_FASTEST = 100
_DPI = 100
_COLOURS = 64
_NEAR = 8
"""Distance of a colour from that of the paper, of 255, within which it becomes that."""
_HUNDREDTH = 10
"""Milliseconds of the unit in which a .gif keeps times."""
_FASTEST_GIF = 50
"""Frames a second: what is shorter browsers show for a tenth of a second."""


def video(
    log: str | os.PathLike[str] | Log,
    out: str | os.PathLike[str],
    *,
    periods: float | None = None,
    fps: int = 25,
    size: tuple[int, int] = (800, 450),
) -> Path:
    """Write a film of the end of a run.

    Parameters
    ----------
    log : path-like or Log
        A run of one ball or of several, or an orbit.
    out : path-like
        The file, .mp4 (needs the program ffmpeg) or .gif; an existing one is replaced.
    periods : float, optional
        Forcing cycles, up to the end of the run; ten, or all if there are fewer, if left out.
    fps : int
        Frames a second, at most 100, of a .gif 50; a forcing cycle lasts two seconds.
    size : tuple of int
        Width and height in pixels; odd ones are made even.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    FileMissingError
        If the log or the folder of `out` does not exist.
    ParameterError
        If `periods` or `fps` is out of range, or both together make more than 5000 frames.
    ViewerError
        If the log holds no motion of balls, `out` ends otherwise, or ffmpeg is missing or fails.
    """
    target = Path(out)
    if target.suffix.lower() not in FORMATS:
        raise ViewerError(f"{target} does not end in {' or '.join(FORMATS)}")
    run = log if isinstance(log, Log) else read(log)
    if run.states.num_rows < 2:
        raise ViewerError(f"{run.path} holds no states of a ball, so there is no motion to show")
    program = shutil.which("ffmpeg")
    if target.suffix.lower() == ".mp4" and program is None:
        raise ViewerError("an mp4 needs the program ffmpeg, which is not there; name a .gif, or install ffmpeg")
    times = _times(run, periods, fps, _FASTEST_GIF if target.suffix.lower() == ".gif" else _FASTEST)
    width, height = (side + side % 2 for side in size)
    frames = _frames(run, times, (width, height))
    with replacing(target) as partial:
        if target.suffix.lower() == ".gif":
            _gif(frames, partial, fps)
        else:
            _mp4(str(program), frames, partial, fps, (width, height))
    return target


def _times(run: Log, periods: float | None, fps: int, fastest: int = _FASTEST) -> np.ndarray:
    """Return the times of the frames, at equal distances, up to the end of the run."""
    period = 2 * math.pi / run.parameters.get("Omega", 1.0)
    first, last = run.states["t"].to_numpy()[[0, -1]].tolist()
    whole = (last - first) / period
    if periods is not None and not 0.0 < periods <= whole * (1 + 1e-9):
        raise ParameterError(f"periods is {periods:g}, allowed is more than 0 and up to {whole:.6g}, the run")
    if not 1 <= fps <= fastest:
        told = " of a .gif" if fastest < _FASTEST else ""
        raise ParameterError(f"fps is {fps}, allowed is 1 to {fastest}{told}")
    shown = min(10.0, whole) if periods is None else min(periods, whole)
    count = max(2, round(shown * SECONDS_PER_CYCLE * fps))
    if count > _MOST_FRAMES:
        raise ParameterError(
            f"{shown:g} periods at {fps} frames a second are {count} frames, {_MOST_FRAMES} are allowed"
        )
    return last - shown * period * np.linspace(1.0, 0.0, count, endpoint=False)


def _frames(run: Log, times: np.ndarray, size: tuple[int, int]) -> Iterator[np.ndarray]:
    """Yield the frames, shape (height, width, 3)."""
    need("matplotlib")
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    from vines.viewer._film import Film

    figure = Figure(figsize=(size[0] / _DPI, size[1] / _DPI), dpi=_DPI, layout="constrained")
    canvas = FigureCanvasAgg(figure)
    film = Film(figure, run, times)
    # Laid out once: for each frame anew it takes most of the time, and labels would jump.
    canvas.draw()
    figure.set_layout_engine("none")
    for k in range(len(times)):
        film.show(k)
        canvas.draw()
        yield np.asarray(canvas.buffer_rgba())[..., :3].copy()


def _gif(frames: Iterator[np.ndarray], out: Path, fps: int) -> None:
    """Write frame by frame, of each but the first the part that differs from the one before."""
    need("PIL")
    from PIL import Image, ImageChops
    from PIL.GifImagePlugin import getdata

    before = _quantized(next(frames))
    begun = io.BytesIO()
    before.save(begun, format="GIF", loop=0, duration=_HUNDREDTH * _hundredths(0, fps), optimize=False)
    with out.open("wb") as stream:
        # Without the last byte, which ends the film: Pillow alone would keep all frames in memory.
        stream.write(begun.getvalue()[:-1])
        for k, frame in enumerate(frames, 1):
            now = Image.fromarray(frame).quantize(palette=before, dither=Image.Dither.NONE)
            box = ImageChops.difference(before.convert("RGB"), now.convert("RGB")).getbbox() or (0, 0, 1, 1)
            duration = _HUNDREDTH * _hundredths(k, fps)
            stream.writelines(getdata(now.crop(box), (box[0], box[1]), duration=duration))
            before = now
        stream.write(b";")


def _quantized(frame: np.ndarray) -> Image.Image:
    """Return a frame in few colours, the paper of its corner as it is."""
    need("PIL")
    from PIL import Image

    found = Image.fromarray(frame).quantize(_COLOURS)
    colours = np.array(found.getpalette(), np.uint8).reshape(-1, 3)
    paper = frame[0, 0].astype(int)
    # Pillow looks colours up in steps of four: what is so near would be taken for the paper's own.
    colours[(np.abs(colours - paper) <= _NEAR).all(axis=1)] = paper
    found.putpalette(colours.tobytes())
    return found


def _hundredths(k: int, fps: int) -> int:
    """Return for how many hundredths of a second frame `k` is shown: whole ones, and no drift.

    Examples
    --------
    >>> [_hundredths(k, 30) for k in range(6)]
    [3, 4, 3, 3, 4, 3]
    """
    first, last = (round(100 * number / fps) for number in (k, k + 1))
    return last - first


def _mp4(program: str, frames: Iterator[np.ndarray], out: Path, fps: int, size: tuple[int, int]) -> None:
    """Hand the frames to ffmpeg as they are drawn."""
    taken = ("-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{size[0]}x{size[1]}", "-r", str(fps), "-i", "-")
    made = ("-pix_fmt", "yuv420p", "-movflags", "+faststart", "-f", "mp4", str(out))
    command = [program, "-loglevel", "error", "-y", *taken, *made]
    with (
        tempfile.TemporaryFile() as said,
        subprocess.Popen(command, stdin=subprocess.PIPE, stdout=said, stderr=said) as process,
    ):
        assert process.stdin is not None
        try:
            # Where it ends early its own words, below, say why.
            with contextlib.suppress(BrokenPipeError), process.stdin as pipe:
                for frame in frames:
                    pipe.write(frame.tobytes())
        except BaseException:
            process.kill()
            raise
        status = process.wait()
        said.seek(0)
        lines = said.read().decode(errors="replace").strip().splitlines() or ["it said nothing"]
    if status:
        raise ViewerError(f"ffmpeg ended with status {status}: {lines[-1]}; a .gif needs no ffmpeg")
