// The greedy agent in motion: an episode on a canvas, with a pause button and a slider for its steps.

import { acrobot } from "./acrobot.js";
import { blackjack, taxi } from "./games.js";
import { cartPole, gridWorld, mountainCar } from "./scenes.js";
import { onResize, surface } from "./surface.js";
import { onThemeChange } from "./theme.js";
import { counted, number } from "../format.js";

const SCENES = { mountain_car: mountainCar, cart_pole: cartPole, acrobot, taxi, blackjack };
const PAUSE_AT_END = 1.2;
const MAX_TRAIL = 60;

/** Plays episodes. `onStep(step)` is called with the step shown, or with null if none is shown. */
export class Motion {
  constructor({ canvas, button, slider, caption, onStep }) {
    Object.assign(this, { canvas, button, slider, caption, onStep });
    this.episode = null;
    this.world = null;
    this.time = 0;
    this.last = 0;
    this.playing = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.frame = null;
    button.addEventListener("click", () => this.setPlaying(!this.playing));
    slider.addEventListener("input", () => {
      this.setPlaying(false);
      this.time = Number(slider.value);
      this.draw();
    });
    onResize([canvas], () => this.draw());
    onThemeChange(() => this.draw());
    this.setPlaying(this.playing);
  }

  /** Sets the environment: {drawing, layout, wind, rewards, actions}. */
  setWorld(world) {
    this.world = world;
    this.episode = this.described = null;
    this.time = 0;
    this.scene = SCENES[world.drawing] ?? gridWorld;
    this.draw();
  }

  /** Shows a greedy episode from its start, unless it is already shown. `when` says how long the agent has learned. */
  show(episode, when = "") {
    const same = this.episode && !this.episode.current && sameEpisode(this.episode, episode);
    this.episode = episode;
    this.described = null;
    this.slider.disabled = false;
    this.slider.max = episode.actions.length;
    if (!same) this.time = 0;
    this.caption.textContent = this.words(episode, when);
    this.draw();
  }

  /** A greedy episode in words. */
  words(episode, when = "") {
    const steps = counted(episode.actions.length, "step");
    const name = `Greedy episode${when}: return ${number(episode.return)}`;
    if (!episode.terminated && !episode.truncated) return `${name} in its first ${steps}; the rest is not shown.`;
    const end = episode.terminated ? this.scene.outcome(this.momentAt(episode.actions.length, episode), episode) : "time is up";
    return `${name} in ${steps}: ${end}.`;
  }

  /** Shows a single moment of the episode in training. */
  showCurrent(current, text) {
    const { observation, cell, nextAction } = current;
    this.described = null;
    this.episode = { current: true, observations: observation, components: observation.length, cells: [cell] };
    this.episode.actions = nextAction === null ? [] : [nextAction];
    this.time = 0;
    this.slider.max = 0;
    this.slider.disabled = true;
    this.caption.textContent = text;
    this.draw();
  }

  setPlaying(playing) {
    this.playing = playing;
    this.button.textContent = playing ? "Pause" : "Play";
    this.button.setAttribute("aria-label", playing ? "Pause the motion" : "Play the motion");
    if (playing && this.frame === null) {
      this.last = performance.now();
      this.frame = requestAnimationFrame((now) => this.tick(now));
    }
  }

  tick(now) {
    this.frame = null;
    if (!this.playing) return;
    const seconds = Math.min((now - this.last) / 1000, 0.1);
    this.last = now;
    if (this.episode && !this.episode.current) {
      const steps = this.episode.actions.length;
      this.time += seconds * this.scene.stepsPerSecond;
      if (this.time > steps + PAUSE_AT_END * this.scene.stepsPerSecond) this.time = 0;
      this.draw();
    }
    this.frame = requestAnimationFrame((next) => this.tick(next));
  }

  draw() {
    if (!this.world) return;
    const { g, width, height } = surface(this.canvas);
    const moment = this.momentAt(this.time);
    if (!moment) return;
    this.scene.draw(g, width, height, moment);
    if (!this.episode || this.episode.current) {
      this.describe(moment);
      return;
    }
    const step = Math.floor(Math.min(this.time, this.episode.actions.length));
    // Several frames show the same step; its description changes only with the step.
    if (this.episode === this.described && step === this.describedStep) return;
    Object.assign(this, { described: this.episode, describedStep: step });
    this.describe(moment);
    this.slider.value = step;
    this.slider.setAttribute("aria-valuetext", `step ${step} of ${this.episode.actions.length}`);
    this.onStep(step);
  }

  describe(moment) {
    this.canvas.setAttribute("aria-label", `The agent: ${this.scene.alternative(moment)}.`);
  }

  /** The content of the scene at a time of an episode: an observation and the action, and the cells on a grid. */
  momentAt(shownTime, episode = this.episode) {
    const { layout, wind, rewards, drawing } = this.world;
    if (!episode) return layout ? { layout, wind, rewards, drawing, cell: null, from: null, share: 1, trail: [] } : null;
    const { observations, components, actions, cells } = episode;
    const time = Math.min(shownTime, actions.length);
    const step = episode.current ? 0 : Math.floor(time);
    const action = step < actions.length ? actions[step] : null;
    const observation = observations.slice(step * components, (step + 1) * components);
    if (!layout) return { observation, action };
    const share = time - step;
    const next = episode.current ? cells[0] : cells[Math.min(step + 1, cells.length - 1)];
    const trail = episode.current ? [] : Array.from(cells.slice(Math.max(step - MAX_TRAIL, 0), step + 1));
    return { layout, wind, rewards, drawing, observation, action, cell: next, from: cells[step], share, trail };
  }
}

function sameEpisode(left, right) {
  if (left.actions.length !== right.actions.length || left.cells[0] !== right.cells[0]) return false;
  return left.cells.every((cell, step) => cell === right.cells[step]);
}
