// Panel, scene, eyebox, the zone without aliasing, the focus and the eye in space, by WebGL 2.

import { change, clamp, session, state } from './state.js';

const canvas = document.getElementById('space');
const colours = { panel: [0.36, 0.49, 0.98], zone: [0.18, 0.64, 0.42], focus: [0.95, 0.64, 0.24], eye: [0.88, 0.33, 0.61] };
let gl = null, program = null, buffer = null, scene = new Float32Array(0);
let turn = 0.75, tilt = 0.32;  // of the picture [rad]

const vertexSource = `#version 300 es
in vec3 place; in vec4 tint; uniform mat4 camera; uniform float dot; out vec4 colour;
void main() { gl_Position = camera * vec4(place, 1.0); gl_PointSize = dot; colour = tint; }`;
const fragmentSource = `#version 300 es
precision mediump float; in vec4 colour; out vec4 shown; void main() { shown = colour; }`;

function shader(type, source) {
  const made = gl.createShader(type);
  gl.shaderSource(made, source);
  gl.compileShader(made);
  return made;
}

/** Prepares the picture. @param points x, y, z [m] and brightness of each point of the scene */
export function startSpace(points) {
  scene = points;
  if (!gl) {
    gl = canvas.getContext('webgl2', { antialias: true });
    if (!gl) {
      canvas.setAttribute('aria-label', 'The picture in space needs WebGL 2, which this browser does not offer.');
      return;
    }
    program = gl.createProgram();
    gl.attachShader(program, shader(gl.VERTEX_SHADER, vertexSource));
    gl.attachShader(program, shader(gl.FRAGMENT_SHADER, fragmentSource));
    gl.linkProgram(program);
    buffer = gl.createBuffer();
  }
  drawSpace();
}

// Half sizes of all that is shown [mm]: across, and how far it reaches behind and before the panel.
function extent() {
  const p = session.panel, across = (Math.max(p.columns, p.rows) * p.pitch_m * 1e3) / 2;
  const places = [state.distance, ...session.depths_m.map(m => m * 1e3)].map(depth => imageSide() * depth);  // z
  const behind = Math.max(...places.map(Math.abs)) || across;  // on both sides: the zone and the eyebox are mirrored
  let half = across;
  for (let i = 0; i < scene.length; i += 4)  // of the points that are not images far away
    if (Math.abs(scene[i + 2]) * 1e3 <= behind) half = Math.max(half, Math.abs(scene[i] * 1e3), Math.abs(scene[i + 1] * 1e3));
  half = Math.max(half, Math.min(2.2 * across, behind * p.acceptance_tangent - across));
  return { half, behind, before: Math.max(behind * 0.35, ...places, state.pupil > 0 ? state.eye[2] * 1.1 : 0) };
}

// The side of the panel on which positive distances are: a real image stands in front of the panel.
const imageSide = () => (session.items[0]?.image === 'real' ? 1 : -1);

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

// The axes of the picture in space, and the place [mm] to [-1, 1]: depth is drawn shorter than it is.
function projection() {
  const { half, behind, before } = extent(), long = (2.6 * half) / (behind + before);
  const right = [Math.cos(turn), 0, -Math.sin(turn)];
  const up = [-Math.sin(turn) * Math.sin(tilt), Math.cos(tilt), -Math.cos(turn) * Math.sin(tilt)];
  const toward = [Math.sin(turn) * Math.cos(tilt), Math.sin(tilt), Math.cos(turn) * Math.cos(tilt)];
  const middle = ((before - behind) / 2) * long, aspect = canvas.clientWidth / canvas.clientHeight;
  const size = 1 / (1.35 * half), wide = Math.min(1, aspect);
  const axes = [right.map(v => (v * size * wide) / aspect), up.map(v => v * size * wide), toward.map(v => -v * size * 0.2)];
  const offset = axes.map(axis => -axis[2] * middle);
  return { axes, offset, long };
}

function matrix({ axes, offset, long }) {
  const m = new Float32Array(16);
  for (let row = 0; row < 3; ++row) {
    m[row] = axes[row][0];
    m[4 + row] = axes[row][1];
    m[8 + row] = axes[row][2] * long;
    m[12 + row] = offset[row];
  }
  m[15] = 1;
  return m;
}

function onCanvas(place) {
  const { axes, offset, long } = projection(), scaled = [place[0], place[1], place[2] * long];
  return [((dot(axes[0], scaled) + offset[0] + 1) / 2) * canvas.clientWidth, ((1 - dot(axes[1], scaled) - offset[1]) / 2) * canvas.clientHeight];
}

function rectangle(lines, halfX, halfY, z, colour) {
  const corners = [[-halfX, -halfY], [halfX, -halfY], [halfX, halfY], [-halfX, halfY]];
  corners.forEach((corner, i) => lines.push(...corner, z, ...colour, ...corners[(i + 1) % 4], z, ...colour));
}

// The zone whose points light the whole panel: half side R(z) − S/2 along each axis.
function zone(lines, panelX, panelY, tangent, far, sign) {
  const colour = [...colours.zone, 0.9], halves = z => [z * tangent - panelX, z * tangent - panelY];
  const begin = panelX / tangent;
  if (!(begin < far)) return;
  const [x, y] = halves(far), [, low] = halves(begin);
  rectangle(lines, x, y, sign * far, colour);
  for (const [a, b] of [[-1, -1], [1, -1], [1, 1], [-1, 1]])
    lines.push(0, b * low, sign * begin, ...colour, a * x, b * y, sign * far, ...colour);
}

function eyePlace() { return state.pupil > 0 ? state.eye : [0, 0, extent().before]; }

function lineVertices() {
  const p = session.panel, lines = [], { behind, before } = extent();
  const halfX = (p.columns * p.pitch_m * 1e3) / 2, halfY = (p.rows * p.pitch_m * 1e3) / 2;
  for (let i = 0; i <= 8; ++i) {  // the panel as a lattice
    const x = halfX * (i / 4 - 1), y = halfY * (i / 4 - 1);
    lines.push(x, -halfY, 0, ...colours.panel, 1, x, halfY, 0, ...colours.panel, 1, -halfX, y, 0, ...colours.panel, 1, halfX, y, 0, ...colours.panel, 1);
  }
  zone(lines, halfX, halfY, p.acceptance_tangent, behind, -1);
  zone(lines, halfX, halfY, p.acceptance_tangent, before, 1);  // mirrored: the eyebox
  const sign = imageSide();
  rectangle(lines, halfX, halfY, sign * state.distance, [...colours.focus, 1]);
  const [x, y, z] = eyePlace(), radius = Math.max(state.pupil / 2, 0.4);
  for (let i = 0; i < 32; ++i)
    for (const angle of [(i * Math.PI) / 16, ((i + 1) * Math.PI) / 16])
      lines.push(x + radius * Math.cos(angle), y + radius * Math.sin(angle), z, ...colours.eye, 1);
  lines.push(x, y, z, ...colours.eye, 0.5, 0, 0, sign * state.distance, ...colours.eye, 0.5);
  return new Float32Array(lines);
}

function sceneVertices() {
  const out = [], isDark = document.documentElement.dataset.theme === 'dark';
  for (let i = 0; i < scene.length; i += 4) {
    const b = isDark ? 0.35 + 0.65 * scene[i + 3] : 0.6 - 0.5 * scene[i + 3];
    out.push(scene[i] * 1e3, scene[i + 1] * 1e3, -imageSide() * scene[i + 2] * 1e3, b, b, b, 1);
  }
  return new Float32Array(out);
}

function drawVertices(vertices, mode) {
  gl.bufferData(gl.ARRAY_BUFFER, vertices, gl.DYNAMIC_DRAW);
  gl.drawArrays(mode, 0, vertices.length / 7);
}

let isPlanned = false;
/** Draws the picture at the next chance. */
export function drawSpace() {
  if (!gl || !session.panel || isPlanned) return;
  isPlanned = true;
  requestAnimationFrame(() => {
    isPlanned = false;
    const ratio = devicePixelRatio;
    canvas.width = canvas.clientWidth * ratio;
    canvas.height = canvas.clientHeight * ratio;
    if (canvas.width === 0) return;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.useProgram(program);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    const place = gl.getAttribLocation(program, 'place'), tint = gl.getAttribLocation(program, 'tint');
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 28, 0);
    gl.enableVertexAttribArray(tint);
    gl.vertexAttribPointer(tint, 4, gl.FLOAT, false, 28, 12);
    gl.uniformMatrix4fv(gl.getUniformLocation(program, 'camera'), false, matrix(projection()));
    gl.uniform1f(gl.getUniformLocation(program, 'dot'), 1.6 * ratio);
    drawVertices(sceneVertices(), gl.POINTS);
    drawVertices(lineVertices(), gl.LINES);
    gl.uniform1f(gl.getUniformLocation(program, 'dot'), 9 * ratio);
    drawVertices(new Float32Array([...eyePlace(), ...colours.eye, 1]), gl.POINTS);
    [canvas.dataset.eyeX, canvas.dataset.eyeY] = onCanvas(eyePlace()).map(v => v.toFixed(1));
  });
}

let press = null;
canvas.addEventListener('pointerdown', event => {
  if (!session.panel) return;
  canvas.setPointerCapture(event.pointerId);
  const box = canvas.getBoundingClientRect(), at = onCanvas(eyePlace());
  const isEye = Math.hypot(event.clientX - box.left - at[0], event.clientY - box.top - at[1]) < 18;
  press = { x: event.clientX, y: event.clientY, turn, tilt, eye: isEye ? [...eyePlace()] : null };
});
canvas.addEventListener('pointermove', event => {
  if (!press) return;
  const dx = event.clientX - press.x, dy = event.clientY - press.y;
  if (press.eye) {
    const { axes } = projection();
    const x = press.eye[0] + (2 * dx) / canvas.clientWidth / (axes[0][0] || 1);
    const y = press.eye[1] - (2 * dy) / canvas.clientHeight / (axes[1][1] || 1);
    change({ pupil: state.pupil > 0 ? state.pupil : 4, eye: [x, y, press.eye[2]].map(v => Number(v.toFixed(2))) });
    return;
  }
  turn = press.turn + dx * 0.008;
  tilt = clamp(press.tilt + dy * 0.008, -1.2, 1.2);
  drawSpace();
});
for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, () => { press = null; });
canvas.addEventListener('keydown', event => {
  const moves = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
  if (!moves[event.key]) return;
  event.preventDefault();
  turn += moves[event.key][0];
  tilt = clamp(tilt + moves[event.key][1], -1.2, 1.2);
  drawSpace();
});
new ResizeObserver(drawSpace).observe(canvas);
