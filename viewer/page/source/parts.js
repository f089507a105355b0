// What other pages use of this one: the picture of a model, its colours, and how it is unpacked.

export { pathColor, scaleOf } from "./colors.js";
export { buildShapes } from "./shapes.js";
export { number } from "./text.js";
export { decodeModel } from "./unpack.js";
export { NAMED_VIEWS, View } from "./view.js";
