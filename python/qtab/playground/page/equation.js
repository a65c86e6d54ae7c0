// An update as an equation: in symbols, and with its numbers.

import { number, term } from "./format.js";

const DIGITS = 5;

/** The equation of an algorithm's updates in symbols; `bootstrap`: how its target takes the value of the next state. */
export function symbolEquation(kind, bootstrap) {
  if (kind === "assign") return "Q(S, A) ← R";
  if (kind === "n_step") return "Q(S, A) ← Q(S, A) + α [G − Q(S, A)]";
  const target = `R + γ ${bootstrap.replaceAll("'", "′")}`;
  return `Q(S, A) ← Q(S, A) + α ${kind === "trace" ? "z " : ""}[${target} − Q(S, A)]`;
}

/** The same with the numbers of an update, as parts: the last one is the new value. */
export function numberEquation(update) {
  const { kind, old, reward, nextValue, target, learningRate, discount } = update;
  const after = number(update.new, DIGITS);
  if (kind === "assign") return ["Q(S, A) ← ", after];
  const error = `${targetNumbers(update, kind, reward, nextValue, target, discount)} − ${term(old, DIGITS)}`;
  if (kind === "trace") return [`δ = ${error} = ${number(target - old, DIGITS)}, and Q(S, A) from ${number(old, DIGITS)} to `, after];
  return [`${number(old, DIGITS)} + ${number(learningRate, DIGITS)} · [${error}] = `, after];
}

function targetNumbers({ next }, kind, reward, nextValue, target, discount) {
  if (kind === "n_step") return number(target, DIGITS);
  if (nextValue === null || next === "terminal") return number(reward, DIGITS);
  return `${number(reward, DIGITS)} + ${number(discount, DIGITS)} · ${term(nextValue, DIGITS)}`;
}
