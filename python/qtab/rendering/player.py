"""Players for HTML pages and notebooks: a video, or pictures with a slider, both usable with the keyboard."""

from collections.abc import Sequence
from html import escape

from qtab.rendering.formats import mp4_uri, png_uris
from qtab.rendering.frames import Frames

# Attributes instead of a script element: notebooks run them, and several players on a page share no names.
_MOVE = (
    "const f=this.closest('figure'),p=f.querySelectorAll('img'),n=+this.value;"
    "p.forEach((e,i)=>{e.style.display=i===n?'':'none'});const o=f.querySelector('output');"
    "o.textContent=p[n].dataset.label;this.setAttribute('aria-valuetext',p[n].dataset.label)"
)
_PLAY = (
    "const b=this,r=b.nextElementSibling,stop=()=>{clearInterval(b.timer);b.timer=0;b.textContent='Play'};"
    "if(b.timer){stop();return}b.textContent='Pause';b.timer=setInterval(()=>{if(!b.isConnected){stop();return}"
    "r.value=(+r.value+1)%(+r.max+1);r.dispatchEvent(new Event('input'))},"
)
_CONTROLS = "display:flex;gap:.6rem;align-items:center;max-width:40rem;font:13px/1.4 system-ui,sans-serif"


def episode_player(frames: Frames, title: str) -> str:
    """Returns a player of an episode: a video, or without ffmpeg pictures with a slider.

    Args:
        frames: The pictures.
        title: The subject of the pictures, for screen readers.
    """
    uri = mp4_uri(frames)
    if uri is None:
        return slider(list(png_uris(frames)), frames.labels, frames.fps, title, start=0)
    width, height = frames.size
    shape = f'width="{width}" height="{height}" style="max-width:100%;height:auto"'
    video = f'<video controls loop muted playsinline {shape} aria-label="{escape(title)}" src="{uri}"></video>'
    return f'<figure style="margin:0">{video}</figure>'


def slider(pictures: Sequence[str], labels: Sequence[str], fps: float, title: str, start: int | None = None) -> str:
    """Returns pictures with a slider and a button that plays them. Without scripts one picture is shown.

    Args:
        pictures: URIs.
        labels: The label of each picture.
        fps: The number of pictures per second.
        title: The subject of the pictures, for screen readers.
        start: The index of the picture that is shown first; None means the last.
    """
    last = len(pictures) - 1
    first = last if start is None else start
    images = "".join(
        f'<img src="{uri}" alt="{escape(f"{title}, {label}")}" data-label="{escape(label)}" '
        f'style="max-width:100%{"" if index == first else ";display:none"}">'
        for index, (uri, label) in enumerate(zip(pictures, labels, strict=True))
    )
    shown = escape(labels[first])
    controls = (
        f'<div style="{_CONTROLS}"><button type="button" onclick="{escape(_PLAY)}{1000 / fps:.0f})">Play</button>'
        f'<input type="range" min="0" max="{last}" step="1" value="{first}" style="flex:1" '
        f'aria-label="{escape(title)}" aria-valuetext="{shown}" oninput="{escape(_MOVE)}">'
        f'<output aria-live="off" style="min-width:11em">{shown}</output></div>'
    )
    return f'<figure style="margin:0">{images}{controls if last else ""}</figure>'
