// What the page loads when the drawing in space is opened: `robot3d` with one class.

export { Scene } from "./scene";
