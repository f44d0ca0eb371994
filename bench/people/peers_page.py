"""A page of films by several: tables, and for each film a picture of any of them beside the truth, with a slider between two."""
import base64
import html
import subprocess

HEAD = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>Beside Cycles and its denoiser</title>
<style>
body { font: 16px/1.5 system-ui, sans-serif; margin: 0 auto; padding: 1rem; max-width: 80rem; color: #222; background: #fff }
.scroll { overflow-x: auto } table { border-collapse: collapse; font-size: .85rem } td, th { padding: .2rem .5rem; border-bottom: 1px solid #ddd; text-align: left }
.pair { position: relative; line-height: 0; max-width: 100%; width: 960px } .pair img { width: 100%; image-rendering: pixelated }
.pair img + img { position: absolute; left: 0; top: 0; clip-path: inset(0 0 0 50%) }
input[type=range] { width: 100%; max-width: 960px } label { margin-right: 1rem; display: inline-block }
</style></head><body>
<h1>Beside Cycles and its denoiser</h1>
"""
SCRIPT = """<script>
for (const film of document.querySelectorAll("section.film")) {
  const [left, right] = film.querySelectorAll("select"), [below, above] = film.querySelectorAll("img"), range = film.querySelector("input");
  const show = () => { below.src = left.value; above.src = right.value; above.style.clipPath = `inset(0 0 0 ${range.value}%)`; };
  for (const control of [left, right, range]) control.addEventListener("input", show);
  show();
}
</script></body></html>
"""


def still(film, index):
    """A decoded picture of a film as a PNG."""
    words = ["ffmpeg", "-v", "error", "-i", str(film), "-vf", f"select=eq(n\\,{index})", "-frames:v", "1", "-f", "image2pipe", "-c:v", "png", "-"]
    return subprocess.run(words, stdout=subprocess.PIPE, check=True).stdout


def pictures_of(films, index):
    """{name: PNG} of a picture, counted from 0, of what blender/beside_cycles/compare.py says of `films`."""
    pictures = {f"ours, {quantiser}": still(film, index) for quantiser, film in films["ours"].items()}
    pictures |= {f"Cycles {samples}, denoised": still(film, index) for samples, film in films["cycles"].items()}
    return pictures | {"truth (half of its samples)": still(films["truth"], index)}


def table_of(lines):
    rows = [[html.escape(cell.strip()) for cell in line.strip("|").split("|")] for line in lines if not line.startswith("|---")]
    body = "".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows[1:])
    return "<div class=scroll><table><tr>" + "".join(f"<th>{cell}</th>" for cell in rows[0]) + f"</tr>{body}</table></div>"


def film_of(name, pictures):
    def choice(which, chosen):
        options = "".join(f'<option value="data:image/png;base64,{base64.b64encode(png).decode()}"{" selected" if k == chosen else ""}>{html.escape(label)}</option>'
                          for k, (label, png) in enumerate(pictures.items()))
        return f'<label>{which} <select>{options}</select></label>'
    return (f"<section class=film><h2>{html.escape(name)}</h2><p>{choice('Left', 0)}{choice('Right', len(pictures) - 1)}</p>"
            '<input type=range min=0 max=100 value=50 aria-label="Where left ends"><div class=pair><img alt="left"><img alt="right"></div></section>')


def write(path, lines, films):
    """Tables (Markdown's, empty lines between them) and {film: {name: PNG}} as a page of one file."""
    tables = [[]]
    for line in lines:
        if line:
            tables[-1].append(line)
        else:
            tables.append([])
    path.write_text(HEAD + "".join(table_of(t) for t in tables) + "".join(film_of(n, p) for n, p in films.items()) + SCRIPT)
