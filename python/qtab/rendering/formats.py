"""Videos as MP4, GIF or HTML, from frames."""

import base64
import io
import tempfile
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks
from qtab._utils.extras import missing
from qtab._utils.files import check_writable, replacing
from qtab._utils.shown import did_you_mean
from qtab.rendering.frames import Frames

FORMATS = (".mp4", ".gif", ".html")
MAX_GIF_FPS = 50.0
"""Browsers slow down a GIF with shorter delays than 0.02 s."""
PALETTE_FRAMES = 16
"""The approximate number of pictures whose colors make the palette of all."""
EXACT_COLORS = 8
"""The number of the most frequent colors, such as that of the background, that are kept exactly."""
QUALITY = 7
"""The quality, from 1 to 10: with 7 letters stay sharp, and an episode of Mountain Car takes about 40 kB."""


def check_video_path(path: Any) -> Path:
    """Checks that a video can be written to a path in the format of its suffix, and returns the path.

    Raises:
        ModuleNotFoundError: if the library for the format is missing; the message names the ``pip install``.
        OSError: if the file cannot be written.
        TypeError: if it is not a path.
        ValueError: if the suffix is not that of a known format.
    """
    target = checks.file_path("path", path)
    if target.suffix.lower() not in FORMATS:
        suggestion = did_you_mean(target.suffix.lower(), FORMATS) if target.suffix else ""
        raise ValueError(f"path must end in one of {', '.join(FORMATS)}, got {str(path)!r}{suggestion}")
    if target.suffix.lower() == ".mp4":
        ffmpeg()
    elif target.suffix.lower() == ".gif":
        _pillow()
    check_writable("path", target)
    return target


def save_video(frames: Frames, path: Path, to_html: Callable[[], str]) -> None:
    """Writes a video to a path that :func:`check_video_path` accepted, completely or not at all.

    Args:
        frames: The pictures.
        path: The file.
        to_html: Returns the page for ``.html``.
    """
    with replacing(path) as temporary:
        if path.suffix.lower() == ".mp4":
            write_mp4(frames, temporary)
        elif path.suffix.lower() == ".gif":
            _write_gif(frames, temporary)
        else:
            temporary.write_text(to_html(), encoding="utf-8")


def write_mp4(frames: Frames, path: Path) -> None:
    """Writes H.264 video, which all browsers play.

    Raises:
        ModuleNotFoundError: without imageio-ffmpeg; the message names the ``pip install``.
        OSError: if ffmpeg fails.
    """
    width, height = frames.size
    padding = ((0, height % 2), (0, width % 2), (0, 0))  # the format needs even sizes
    size = width + width % 2, height + height % 2
    options: dict[str, Any] = {"quality": QUALITY, "macro_block_size": 2, "ffmpeg_log_level": "error"}
    writer = ffmpeg().write_frames(str(path), size, fps=frames.fps, output_params=["-movflags", "faststart"], **options)
    try:
        writer.send(None)
        for picture in frames:
            writer.send(np.ascontiguousarray(np.pad(picture, padding, mode="edge")))
    finally:
        writer.close()
    if not path.exists() or path.stat().st_size == 0:
        raise OSError("ffmpeg could not encode the video")


def mp4_uri(frames: Frames) -> str | None:
    """Returns a data URI of the video as MP4; None if no ffmpeg is installed."""
    try:
        ffmpeg()
    except ModuleNotFoundError:
        return None
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "video.mp4"
        write_mp4(frames, path)
        return data_uri("video/mp4", path.read_bytes())


def png_uris(frames: Frames) -> Iterator[str]:
    """Yields a data URI of each picture as PNG."""
    for image in _images(frames):
        written = io.BytesIO()
        image.save(written, format="png", compress_level=9)
        yield data_uri("image/png", written.getvalue())


def data_uri(kind: str, content: bytes) -> str:
    """Returns content as a data URI."""
    return f"data:{kind};base64,{base64.b64encode(content).decode()}"


def _write_gif(frames: Frames, path: Path) -> None:
    fps = min(frames.fps, MAX_GIF_FPS)
    # Delays are whole hundredths of a second; rounding the times keeps the speed.
    times = [round(100 * index / fps) for index in range(len(frames) + 1)]
    delays = [10 * (after - before) for before, after in pairwise(times)]
    first, *others = _images(frames)
    first.save(path, format="gif", save_all=True, append_images=others, duration=delays, loop=0, disposal=1)


def _images(frames: Frames) -> Iterator[Any]:
    """Yields the pictures with one palette made from some of them, which is much faster than a palette for each.

    The most frequent colors are kept exactly, so that white stays white; Pillow would choose similar ones.
    """
    image = _pillow()
    step = max(len(frames) // PALETTE_FRAMES, 1)
    sample = np.concatenate([picture[::2, ::2] for index, picture in enumerate(frames) if index % step == 0])
    colors, counts = np.unique(_packed(sample), return_counts=True)
    frequent = colors[np.argsort(-counts, kind="stable")[:EXACT_COLORS]].tolist()
    mixed = image.fromarray(sample).quantize(256 - len(frequent), image.Quantize.MEDIANCUT).getpalette()
    chosen = [part for color in frequent for part in (color >> 16, color >> 8 & 255, color & 255)] + mixed
    palette = image.new("P", (1, 1))
    palette.putpalette(chosen[: 3 * 256])
    for picture in frames:
        indices = np.array(image.fromarray(picture).quantize(palette=palette, dither=image.Dither.NONE))
        packed = _packed(picture)
        for index, color in enumerate(frequent):
            indices[packed == color] = index
        shown = image.fromarray(indices)  # of mode L, which a palette turns into P
        shown.putpalette(chosen[: 3 * 256])
        yield shown


def _packed(pictures: NDArray[np.uint8]) -> NDArray[np.uint32]:
    """Returns the color of each pixel as one number."""
    red, green, blue = np.moveaxis(pictures.astype(np.uint32), -1, 0)
    packed: NDArray[np.uint32] = red << 16 | green << 8 | blue
    return packed


def ffmpeg() -> Any:
    """Returns the library that writes MP4.

    Raises:
        ModuleNotFoundError: without it, or without an ffmpeg for it; the message names the ``pip install``.
    """
    try:
        import imageio_ffmpeg  # type: ignore[import-untyped]
    except ModuleNotFoundError as error:
        raise missing(error, "video") from None
    try:
        imageio_ffmpeg.get_ffmpeg_exe()
    except RuntimeError as error:  # the library has no ffmpeg for this platform
        raise missing(ModuleNotFoundError(str(error), name="ffmpeg")) from None
    return imageio_ffmpeg


def _pillow() -> Any:
    try:
        from PIL import Image
    except ModuleNotFoundError as error:
        raise missing(error, "plot") from None
    return Image
