// The page: asks the server for its session, and for pictures whenever something changes.

import * as api from './api.js';
import { buildControls, showCommand, showPanel, showQuality, showReport, writeControls } from './sections.js';
import { buildLive } from './live.js';
import { isSmall, setPoints, show, showRender } from './stage.js';
import { drawSpace, startSpace } from './space.js';
import { redrawCurves, showProgress } from './progress.js';
import { change, distanceRange, onChange, playRange, query, session, state } from './state.js';

const $ = id => document.getElementById(id);
const page = Math.random().toString(36).slice(2, 12);
const patience = 220;  // milliseconds without a change before the view is taken in full resolution

let number = 0, running = null, wantsDraft = false, wantsStill = false, stillTimer = 0, isLost = false, lastShown = 0;

function say(problem) {
  $('problem').textContent = problem;
  $('problem').hidden = problem === '';
}

function fail(error) {
  const isRefused = error instanceof api.Refused;
  if (!isRefused) console.error(error);
  isLost = isRefused && error.message.startsWith('The server does not answer');
  say(isRefused ? error.message : `This page has a fault: ${error.message}`);
}

// One request at a time: what changes meanwhile is asked for once the answer is here. Only a draft does not wait for a still
// view: the server gives that up when it sees the higher number.
async function ask(isDraft) {
  if (session.items.length === 0) return;
  if (running === 'draft' || (running === 'still' && !isDraft)) {
    if (isDraft) wantsDraft = true;
    else wantsStill = true;
    return;
  }
  running = isDraft ? 'draft' : 'still';
  const mine = ++number, asked = query(), start = performance.now();
  try {
    const more = { page, number: String(mine) };
    if (isDraft) more.draft = isSmall() ? '2' : '1';
    const picture = await api.picture(`view?${query(more)}`);
    if (mine !== number) return;
    if (picture) {
      const since = performance.now() - lastShown;
      lastShown += since;
      show(picture, isDraft ? '' : asked);
      drawSpace();
      const all = performance.now() - start;
      document.body.dataset.milliseconds = all.toFixed(0);
      const what = picture.made_of || (isDraft ? 'draft' : ''), rate = isDraft && since < 1000 ? `, ${(1000 / since).toFixed(1)} per second` : '';
      $('status').textContent = `${picture.columns} × ${picture.rows}${what && ', '}${what}, ${all.toFixed(0)} ms${rate}`;
      say(session.problems.concat(picture.warnings).join('\n'));
    }
    if (picture && !isDraft && asked === query()) complete(asked, picture.made_of).catch(fail);
  } catch (error) {
    if (mine === number) fail(error);
  } finally {
    if (mine === number) running = null;
    writeControls();
  }
  if (mine !== number) return;
  const isDraftNext = wantsDraft;
  if (!wantsDraft && !wantsStill) return;
  if (isDraftNext) wantsDraft = false;
  else wantsStill = false;
  ask(isDraftNext);
}

// What belongs to a still view. It is given up as soon as something changes.
async function complete(asked, madeOf) {
  const isOver = () => asked !== query() || running !== null;
  await showCommand();
  if (isOver()) return;
  if (session.live) {
    await Promise.all([showPanel(), showPoints()]);
    if (isOver()) return;
    if (!madeOf.startsWith('optimised') && await improve(asked)) return;
    if (isOver()) return;
  }
  const render = session.has_render ? await api.picture(`reference?${query({ page, number: String(number) })}`).catch(() => null) : null;
  if (asked !== query()) return;
  showRender(render);
  if (isOver()) return;
  const metrics = await api.json(`metrics?${asked}`);
  if (asked !== query()) return;
  showQuality(metrics);
  document.body.dataset.complete = asked;
}

// Optimised holograms of a live scene. @return whether there is something new to show
async function improve(asked) {
  const before = $('status').textContent;
  $('status').textContent = `${before}; finding optimised frames …`;
  const got = await api.json(`improve?${query({ page, number: String(number) })}`).catch(error => ({ problem: error.message }));
  if (asked !== query() || running !== null) return true;
  $('status').textContent = before;
  if (got?.problem) say(`No optimised frames: ${got.problem}`);
  if (got?.is_improved) await ask(false);
  return got?.is_improved ?? false;
}

async function showPoints() {
  const points = new Float32Array(await api.bytes('points'));
  setPoints(points);
  startSpace(points);
}

onChange(values => {
  if (Object.keys(values).join() === 'held') return;
  wantsStill = false;  // of what was before
  if (running !== 'draft') writeControls();  // else with its picture: each change of the page costs as much as a draft
  ask(true);
  clearTimeout(stillTimer);
  stillTimer = setTimeout(() => ask(false), patience);
  if (!('distance' in values)) drawSpace();  // a new focus is drawn with its view: software draws slowly
});

// Play: focus or eye go to and fro, a new draft as soon as the last one is shown, until anything is touched.
const period = 6000;  // milliseconds there and back
let playing = null;

function stop() {
  if (playing) $(`play-${playing.kind}`).setAttribute('aria-pressed', 'false');
  playing = null;
}

function step() {
  if (!playing) return;
  if (running !== 'draft') {
    const { kind, from, to, start, y, z } = playing;
    const part = 0.5 - 0.5 * Math.cos((2 * Math.PI * (performance.now() - start)) / period);
    const at = Number((from + (to - from) * part).toFixed(3));
    change(kind === 'focus' ? { distance: at } : { eye: [at, y, z] });
  }
  requestAnimationFrame(step);
}

function play(kind) {
  const isOn = playing?.kind === kind;
  stop();
  if (isOn || session.items.length === 0) return;
  const { from, to, values } = playRange(kind);
  if (Object.keys(values).length > 0) change(values);
  playing = { kind, from, to, start: performance.now(), y: state.eye[1], z: state.eye[2] };
  $(`play-${kind}`).setAttribute('aria-pressed', 'true');
  step();
}

for (const kind of ['focus', 'parallax']) $(`play-${kind}`).addEventListener('click', () => play(kind));
const presses = event => event.target.closest?.('[id^="play-"]') && (event.type !== 'keydown' || ['Enter', ' '].includes(event.key));
for (const what of ['pointerdown', 'wheel', 'keydown'])
  addEventListener(what, event => { if (!presses(event)) stop(); }, { capture: true, passive: true });

function setRange() {
  const range = $('distance');
  [range.min, range.max] = distanceRange(session.depths_m.map(m => m * 1e3), session.defaults.distance_m * 1e3).map(String);
  range.step = 'any';
}

let loaded = 0;  // the reading of the session that is shown completely
const attempts = { readings: 0, count: 0 };  // at showing the newest reading
const mostAttempts = 3;
let proposed = {};  // focus, pupil and eye that the session has proposed [mm]

async function load() {
  Object.assign(session, await api.json('session'));
  if (isLost) { isLost = false; say(''); }
  if (attempts.readings !== session.readings) Object.assign(attempts, { readings: session.readings, count: 0 });
  if (session.readings !== loaded && attempts.count < mostAttempts) {
    ++attempts.count;
    const name = session.paths.length === 1 ? session.paths[0] : `${session.paths.length} holograms`;
    $('title').textContent = name;
    document.title = `${name} – Holotrace`;
    say(session.problems.join('\n'));
    const { distance_m, pupil_m, eye_m } = session.defaults, millimetres = metres => Number((metres * 1e3).toFixed(4));
    const next = { distance: millimetres(distance_m), pupil: millimetres(pupil_m), eye: eye_m.map(millimetres) };
    for (const name of Object.keys(next))
      if (loaded === 0 || String(state[name]) === String(proposed[name])) state[name] = next[name];
    proposed = next;
    state.shown = null;
    setRange();
    buildControls();
    buildLive();
    writeControls();
    if (session.items.length > 0) {
      await ask(true);  // something to see at once
      await ask(false);
      await showPoints();
      await showPanel();
    }
    if (session.has_report) await showReport();
    loaded = session.readings;
  }
  showProgress(session.progress);
}

// New files and the progress of a running job.
async function watch() {
  try {
    if (!document.hidden) await load();
  } catch (error) {
    fail(error);
  } finally {
    setTimeout(watch, 2000);
  }
}

const themes = matchMedia('(prefers-color-scheme: dark)');
function setTheme(name) {
  document.documentElement.dataset.theme = name;
  drawSpace();
  redrawCurves();
}
$('theme').addEventListener('click', () => setTheme(document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark'));
themes.addEventListener('change', () => setTheme(themes.matches ? 'dark' : 'light'));
setTheme(themes.matches ? 'dark' : 'light');
document.body.dataset.page = page;
watch();
