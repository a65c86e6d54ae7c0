// Elements of the page.

/** A new element with its properties and its children. */
export function make(tag, properties = {}, ...children) {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

/** Shows why a typed value was rejected, at its field and in the paragraph below; null removes the message. */
export function refuse(place, input, message) {
  place.hidden = !message;
  place.textContent = message ? `${message}. The previous value is kept.` : "";
  if (message) input.setAttribute("aria-invalid", "true");
  else input.removeAttribute("aria-invalid");
}

/** The place for such messages. */
export function refusalPlace(properties = {}) {
  const place = make("p", { className: "refused", hidden: true, ...properties });
  place.setAttribute("role", "alert");
  return place;
}
