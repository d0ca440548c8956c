// What the page shows: one object of plain values, in millimetres, and the query that the server understands.

export const state = {
  distance: 300, pupil: 0, eye: [0, 0, 0], focal: 0, exposure: 0,
  hasOrders: false, effects: new Set(), knownEffects: new Set(), shown: null,  // null: all holograms
  edits: {}, held: '',  // of a live scene: values by their keys, and the key of the place that is dragged in the view
};
export const session = { items: [], problems: [], live: null, readings: 0, defaults: { pupil_m: 0 } };

const number = value => String(Number(Number(value).toPrecision(10)));
const length = millimetres => `${number(millimetres)} mm`;

/** The query of the present state. */
export function query(more = {}) {
  const parts = new URLSearchParams();
  parts.set('distance', length(state.distance));
  if (state.pupil > 0) {
    parts.set('pupil', length(state.pupil));
    parts.set('eye', state.eye.map(number).join(' ') + ' mm');
    if (state.focal > 0) parts.set('focal-length', length(state.focal));
  } else if (session.defaults.pupil_m > 0) {
    parts.set('pupil', '0 mm');
  }
  if (state.exposure > 0) parts.set('exposure', number(state.exposure));
  if (state.hasOrders) parts.set('subpixels', '3');
  if (state.knownEffects.size > 0) parts.set('effects', [...state.effects].join(',') || 'none');
  if (state.shown && state.shown.length < session.items.length) parts.set('items', state.shown.join(','));
  for (const [key, value] of Object.entries(state.edits)) parts.set(`set.${key}`, value);
  for (const [key, value] of Object.entries(more)) parts.set(key, value);
  return parts.toString();
}

/** What an eye has: a pupil of 3 mm, 250 mm in front of the panel [mm]. */
export const eye = { pupil: 3, eye: [0, 0, 250] };

/**
 * Where Play and films of a kind go [mm], and what they set before: focus over the slider, parallax over the places from which
 * the whole panel is seen lit, but half a millimetre at least.
 */
export function playRange(kind) {
  if (kind === 'focus') {
    const range = document.getElementById('distance');
    return { from: Number(range.min), to: Number(range.max), values: {} };
  }
  const values = state.pupil > 0 && state.eye[2] > 0 ? {} : { pupil: state.pupil || eye.pupil, eye: eye.eye };
  const [x, , z] = values.eye ?? state.eye, panel = session.panel;
  const lit = panel ? z * panel.acceptance_tangent - (panel.columns * panel.pitch_m * 1e3) / 2 : 0;
  const reach = Number(clamp(lit, 0.5, 5).toFixed(2));
  return { from: Number((x - reach).toFixed(2)), to: Number((x + reach).toFixed(2)), values };
}

const listeners = [];
/** Calls `work(what)` after every change of the state. */
export function onChange(work) { listeners.push(work); }

/** Changes values of the state and tells all listeners. */
export function change(values) {
  Object.assign(state, values);
  for (const work of listeners) work(values);
}

export function clamp(value, low, high) { return Math.min(Math.max(value, low), high); }

/**
 * The ends of the slider of distances [mm]: the depths of the scene and the proposed distance, with a margin.
 * Negative depths are in front of the panel. Depths of 0 and 0 are not known.
 */
export function distanceRange([low, high], at) {
  const isKnown = low !== 0 || high !== 0, reach = Math.abs(at) * 0.15;
  const near = Math.min(isKnown ? low : at - reach, at), far = Math.max(isKnown ? high : at + reach, at);
  const margin = Math.max((far - near) * 0.25, Math.abs(at) * 0.02) || 1;
  return near >= 0 ? [Math.max(0, near - margin), far + margin] : [near - margin, far + margin];
}

/** The colour in which light of a wavelength [m] is drawn. */
export function colourOf(wavelength) {
  const nm = wavelength * 1e9;
  const bump = (centre, width) => Math.exp(-(((nm - centre) / width) ** 2));
  const part = x => Math.round(255 * clamp(x, 0, 1));
  return `rgb(${part(bump(630, 60) + 0.35 * bump(430, 25))},${part(bump(535, 50))},${part(bump(455, 38))})`;
}
