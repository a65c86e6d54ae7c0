// Shapes on a canvas.

/** Fills a disc. */
export function disc(g, x, y, radius, color) {
  g.fillStyle = color;
  g.beginPath();
  g.arc(x, y, radius, 0, 2 * Math.PI);
  g.fill();
}

function path(g, points) {
  g.beginPath();
  points.forEach(([x, y], index) => (index ? g.lineTo(x, y) : g.moveTo(x, y)));
}

/** Draws a line through points, [x, y] each. */
export function line(g, points, color, width) {
  g.strokeStyle = color;
  g.lineWidth = width;
  path(g, points);
  g.stroke();
}

/** Fills the polygon of some points. */
export function polygon(g, points, color) {
  g.fillStyle = color;
  path(g, points);
  g.fill();
}

/** Fills a rectangle with round corners. */
export function roundBox(g, x, y, width, height, radius, color) {
  g.fillStyle = color;
  g.beginPath();
  g.roundRect(x, y, width, height, radius);
  g.fill();
}

/** Draws an arrow through a point, or a dot if it points nowhere. `towards`: [right, down], or null. */
export function arrow(g, x, y, size, towards, color, width) {
  if (!towards) {
    disc(g, x, y, Math.max(size * 0.3, 1.2), color);
    return;
  }
  const [right, down] = towards;
  const [tipX, tipY] = [x + right * size, y + down * size];
  const head = size * 0.75;
  g.strokeStyle = color;
  g.lineWidth = width;
  g.beginPath();
  g.moveTo(x - right * size, y - down * size);
  g.lineTo(tipX, tipY);
  g.moveTo(tipX - right * head - down * head * 0.8, tipY - down * head - right * head * 0.8);
  g.lineTo(tipX, tipY);
  g.lineTo(tipX - right * head + down * head * 0.8, tipY - down * head + right * head * 0.8);
  g.stroke();
}

/** Draws a dot with a light edge, such as the agent on a map. */
export function dot(g, [x, y], radius, color) {
  disc(g, x, y, radius, color);
  g.lineWidth = 1.5;
  g.strokeStyle = "#ffffff";
  g.stroke();
}
