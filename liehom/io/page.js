"use strict";

// The cone that can be turned: points [x, y, z] on the unit sphere, in curves; a curve of one point is a line.
(() => {
  const data = document.getElementById("cone");
  const turn = document.querySelector(".turn");
  if (!data || !turn) return;
  const curves = JSON.parse(data.textContent);
  const canvas = document.createElement("canvas");
  const context = canvas.getContext("2d");
  if (!context) return; // the still picture stays
  const START = [-2.18, 0.38]; // angles about the vertical axis and towards the viewer, as in pictures of the library
  const SECTOR = 16; // segments of a curve
  let [round, up] = START;

  canvas.tabIndex = 0;
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", turn.querySelector("figcaption").textContent);
  turn.querySelector("div").append(canvas);
  for (const [label, name, across, along] of [
    ["←", "turn left", -0.2, 0], ["→", "turn right", 0.2, 0], ["↑", "turn up", 0, 0.2], ["↓", "turn down", 0, -0.2],
    ["reset", "first position", 0, 0],
  ]) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = label;
    button.setAttribute("aria-label", name);
    button.addEventListener("click", () => (label === "reset" ? move(START[0] - round, START[1] - up) : move(across, along)));
    turn.querySelector("div").append(button);
  }
  document.querySelector(".unturned").hidden = true;
  turn.hidden = false;

  // coordinates to the right, upwards and towards the viewer, who looks down by the angle `up`
  function seen([x, y, z]) {
    const right = x * Math.cos(round) - y * Math.sin(round);
    const away = x * Math.sin(round) + y * Math.cos(round);
    return [right, z * Math.cos(up) + away * Math.sin(up), z * Math.sin(up) - away * Math.cos(up)];
  }

  function move(across, along) {
    round += across;
    up = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, up + along));
    draw();
  }

  function colour(name) {
    return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  }

  function draw() {
    const side = canvas.clientWidth;
    const scale = window.devicePixelRatio || 1;
    canvas.width = canvas.height = Math.round(side * scale);
    context.setTransform(scale, 0, 0, scale, 0, 0);
    context.clearRect(0, 0, side, side);
    const radius = 0.4 * side;
    const at = ([a, b]) => [side / 2 + radius * a, side / 2 - radius * b];
    const ink = colour("--ink"), grey = colour("--grey"), pale = colour("--pale"), curve = colour("--curve");

    function line(points, stroke, width, front) {
      context.strokeStyle = stroke;
      context.lineWidth = width;
      context.beginPath();
      let drawing = false;
      for (const point of points) {
        const there = seen(point);
        if (front === undefined || there[2] >= 0 === front) {
          drawing ? context.lineTo(...at(there)) : context.moveTo(...at(there));
          drawing = true;
        } else drawing = false;
      }
      context.stroke();
    }

    // the sphere: its outline, and circles of latitude and longitude in front
    context.strokeStyle = grey;
    context.lineWidth = 1;
    context.beginPath();
    context.arc(side / 2, side / 2, radius, 0, 2 * Math.PI);
    context.stroke();
    const steps = Array.from({ length: 73 }, (_, i) => (i * Math.PI) / 36);
    for (let i = 1; i < 6; i++) {
      const height = Math.cos((i * Math.PI) / 6), wide = Math.sin((i * Math.PI) / 6);
      line(steps.map((t) => [wide * Math.cos(t), wide * Math.sin(t), height]), pale, 0.7, true);
      const [c, s] = [Math.cos((i * Math.PI) / 6), Math.sin((i * Math.PI) / 6)];
      line(steps.map((t) => [Math.sin(t) * c, Math.sin(t) * s, Math.cos(t)]), pale, 0.7, true);
    }
    line(steps.map((t) => [Math.sin(t), 0, Math.cos(t)]), pale, 0.7, true);

    // the sheets have one colour, so their order does not matter; a few wide sectors meet better than many thin ones
    context.fillStyle = curve;
    context.globalAlpha = 0.13;
    for (const points of curves) {
      for (let i = 0; i + 1 < points.length; i += SECTOR) {
        context.beginPath();
        context.moveTo(side / 2, side / 2);
        for (const point of points.slice(i, i + SECTOR + 1)) context.lineTo(...at(seen(point)));
        context.fill();
      }
    }
    for (const points of curves) {
      const ends = points.length > 1 ? points : [points[0].map((x) => -x), [0, 0, 0], points[0]];
      context.globalAlpha = 0.35;
      line(ends, curve, 2, false);
      context.globalAlpha = 1;
      line(ends, curve, 2, true);
    }

    // the ends of the coordinate axes; names behind the sphere are pale
    context.font = `${Math.max(12, side / 28)}px system-ui, sans-serif`;
    context.textAlign = "center";
    context.textBaseline = "middle";
    for (let i = 0; i < 3; i++) {
      const end = [0, 0, 0];
      end[i] = 1;
      line([end, end.map((x) => 1.1 * x)], grey, 1);
      context.fillStyle = seen(end)[2] >= 0 ? ink : grey;
      context.fillText("x" + "₀₁₂"[i], ...at(seen(end.map((x) => 1.18 * x))));
    }
    canvas.dataset.angles = `${round.toFixed(2)} ${up.toFixed(2)}`;
  }

  let last = null;
  canvas.addEventListener("pointerdown", (event) => {
    last = [event.clientX, event.clientY];
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!last) return;
    move((event.clientX - last[0]) / 120, (event.clientY - last[1]) / 120);
    last = [event.clientX, event.clientY];
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => (last = null));
  const KEYS = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
  canvas.addEventListener("keydown", (event) => {
    if (!KEYS[event.key]) return;
    event.preventDefault();
    move(...KEYS[event.key]);
  });
  new ResizeObserver(draw).observe(canvas);
  for (const media of ["(prefers-color-scheme: dark)", "print"]) window.matchMedia(media).addEventListener("change", draw);
})();

// printing opens what is folded
window.addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((part) => (part.open = true)));

// A link to a section unfolds it.
(() => {
  const unfold = () => document.querySelector(`${location.hash || "none"} > details`)?.setAttribute("open", "");
  addEventListener("hashchange", unfold);
  unfold();
})();
