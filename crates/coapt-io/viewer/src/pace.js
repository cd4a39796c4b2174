// How finely a valve is drawn while it moves: as finely as stays smooth on this machine, which is measured and not guessed.

// From the finest, as at rest, to the coarsest; each costs half of the one before or less. `share`: of the resolution at rest, across
// and down. Without a graphics card smooth edges cost most, then pixels.
export const LEVELS = [
  { smoothEdges: true, share: 1 },
  { smoothEdges: false, share: 1 },
  { smoothEdges: false, share: 0.7 },
  { smoothEdges: false, share: 0.5 },
  { smoothEdges: false, share: 0.35 },
];

// Between frames at most, on average [ms]: 30 in a second, which screens of 60 keep by every second one.
export const SMOOTH_MS = 34;

// Frames over which is averaged.
const FRAMES = 4;

// A longer frame counts as so long [ms]: a page that was hidden, or a machine that slept, says nothing of drawing.
const LONGEST_MS = 250;

// After a change, frames that may still wait for what was drawn before it.
const UNSETTLED = 2;

// What a motion leaves of the memory that a level was too slow: after some motions it is tried again.
const REMEMBERED = 0.9;

// `slow_ms`: what a frame of each level took when it was too slow; 0 where it never was.
export function createPace() {
  return { level: 0, slow_ms: LEVELS.map(() => 0), wasLowered: false, unsettled: 0, frames: 0, drawn: 0, spent_ms: 0 };
}

// Something begins to move: as finely as the last motion ended, and from there it may become finer again.
export function beginMotion(pace) {
  pace.slow_ms = pace.slow_ms.map((slow_ms) => REMEMBERED * slow_ms);
  Object.assign(pace, { wasLowered: false, unsettled: 0, frames: 0, drawn: 0, spent_ms: 0 });
}

// Takes note of the time from one frame of a motion to the next, and whether something was drawn in between. Within one motion nothing
// becomes finer once it has become coarser: it would flicker. Frames without drawing tell nothing of what a finer one would take.
export function noteFrame(pace, frame_ms, drew = true) {
  if (pace.unsettled > 0) {
    pace.unsettled -= 1;
    return;
  }
  pace.frames += 1;
  if (drew) pace.drawn += 1;
  pace.spent_ms += Math.min(frame_ms, LONGEST_MS);
  const mean_ms = pace.spent_ms / pace.frames;
  if (pace.spent_ms > FRAMES * SMOOTH_MS) {
    pace.slow_ms[pace.level] = mean_ms;
    pace.wasLowered = true;
    changeLevel(pace, Math.max(1, Math.ceil(Math.log2(mean_ms / SMOOTH_MS))));
  } else if (pace.frames === FRAMES) {
    const finer_ms = Math.max(2 * mean_ms, pace.slow_ms[pace.level - 1] ?? 0);
    changeLevel(pace, !pace.wasLowered && pace.drawn === FRAMES && finer_ms <= SMOOTH_MS ? -1 : 0);
  }
}

function changeLevel(pace, steps) {
  const level = Math.min(Math.max(pace.level + steps, 0), LEVELS.length - 1);
  Object.assign(pace, { level, unsettled: level === pace.level ? 0 : UNSETTLED, frames: 0, drawn: 0, spent_ms: 0 });
}
