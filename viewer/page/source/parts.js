// What other pages use of this one: the picture of a model, its colours, and how it is unpacked.

export { NAMED_VIEWS } from "./cameras.js";
export { pathColor, scaleOf } from "./colors.js";
export { buildShapes } from "./shapes.js";
export { number } from "./text.js";
export { decodeModel } from "./unpack.js";
export { View } from "./view.js";
