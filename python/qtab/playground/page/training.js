// The run that the engine trains: what the buttons do with it, and what its messages mean.

/** Starts, pauses and continues runs of a store's state. */
export class Training {
  constructor(store, Engine, { onStart, onResult, onProblem }) {
    Object.assign(this, { store, onStart, onResult, onProblem });
    this.state = "loading";
    this.id = null;
    this.cell = null;
    this.at = null;
    this.shape = null;
    this.inspectedRun = null;
    this.engine = new Engine({ onMessage: (message) => this.receive(message) });
  }

  /** Trains with the store's settings from the start; the newest request wins. */
  start(run = true) {
    // The map may have other cells; what to inspect is decided with its first result.
    this.engine.inspect(null);
    this.state = run ? "training" : "paused";
    this.at = null;
    this.onStart();
    this.id = this.engine.start({ ...this.store.request(), run });
  }

  receive(message) {
    if (message.type === "error") {
      this.state = "refused";
      this.onProblem(message.message);
    } else if (message.type === "result") {
      this.state = message.state;
      this.at = message.current?.cell ?? null;
      this.onResult(message);
      if (message.state !== "training") this.inspectSoon(message);
    } else if (message.type === "inspection") {
      this.onResult({ type: "inspection", inspection: message });
    }
  }

  /** Continues to the end; a finished run begins anew. */
  run() {
    if (this.state === "paused") {
      this.state = "training";
      this.engine.run();
    } else if (this.state !== "training") this.start();
  }

  stop() {
    if (this.state === "training") this.engine.stop();
  }

  /** A single step or episode; of a run that is finished, the first one. The state of a step is then selected. */
  advance(unit) {
    if (this.state === "training") this.engine.stop();
    else if (this.state !== "paused") this.start(false);
    if (unit === "step" && this.at !== null) this.inspect(this.at);
    this.state = "training";
    this.engine.advance(unit);
  }

  /** The agent before its first step. */
  reset() {
    this.start(false);
  }

  /** Shows the numbers of a cell, now and in later results. */
  inspect(cell) {
    this.cell = cell;
    this.inspectedRun = this.id;
    this.engine.inspect(cell);
  }

  /** Inspects a result after it was drawn: the engine repeats the run for it, which would slow the drawing down. */
  inspectSoon(result) {
    const { id } = this;
    requestAnimationFrame(() => setTimeout(() => id === this.id && this.keepInspecting(result)));
  }

  /** Inspects the cell that was chosen in a new run, too, if its map has it; else the start of the greedy episode. */
  keepInspecting({ map, episode }) {
    const shape = `${this.store.state.environment} ${map.columns} ${map.rows}`;
    if (shape !== this.shape) this.cell = null;
    this.shape = shape;
    if (this.inspectedRun === this.id) return;
    const hasValues = this.cell !== null && !Number.isNaN(map.values[this.cell]);
    const cell = hasValues ? this.cell : episode?.cells[0];
    if (cell !== undefined) this.inspect(cell);
  }
}
