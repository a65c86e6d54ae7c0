// The run that the engine trains: what the buttons do with it, and what its messages mean.

/** Starts, pauses and continues runs of a store's state. */
export class Training {
  constructor(store, Engine, { onStart, onResult, onProblem }) {
    Object.assign(this, { store, onStart, onResult, onProblem });
    this.state = "loading";
    this.id = null;
    this.cell = null;
    this.at = null;
    this.map = null;
    this.inspectedRun = null;
    this.engine = new Engine({ onMessage: (message) => this.receive(message) });
  }

  /** Trains with the store's settings from the start; the newest request wins. */
  start(run = true) {
    this.engine.inspect(null);
    this.state = run ? "training" : "paused";
    this.at = null;
    this.onStart();
    this.id = this.engine.start({ ...this.store.request(), run, inspect: this.watched() });
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

  /** The cell to watch in the next run, with the size of its map; null for that of the first state. */
  watched() {
    const { map, cell } = this;
    return cell !== null && map?.environment === this.store.state.environment ? { cell, columns: map.columns, rows: map.rows } : null;
  }

  /** Inspects a result after it was drawn: the engine repeats the run for a cell that it did not watch. */
  inspectSoon(result) {
    const { id } = this;
    requestAnimationFrame(() => setTimeout(() => id === this.id && this.keepInspecting(result)));
  }

  /** Inspects the cell that was chosen in a new run, too, if its map has it; else the start of the greedy episode. */
  keepInspecting({ map, episode }) {
    const { environment } = this.store.state;
    const { columns, rows } = map;
    const same = this.map && this.map.environment === environment && this.map.columns === columns && this.map.rows === rows;
    if (!same) this.cell = null;
    this.map = { environment, columns, rows };
    if (this.inspectedRun === this.id) return;
    const hasValues = this.cell !== null && !Number.isNaN(map.values[this.cell]);
    this.inspect(hasValues ? this.cell : (episode?.cells[0] ?? null));
  }
}
