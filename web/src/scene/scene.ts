// The robot in space, drawn by three: boxes along its links or their meshes, its bodies as ellipsoids, and the colours of its joints.

import { Box3, type BufferGeometry, Color, GridHelper, Group, HemisphereLight, DirectionalLight, Matrix4, Mesh, PerspectiveCamera, Scene as Space, SRGBColorSpace, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { LinkBody, Rotation, Skeleton } from "../contract";
import { ballAround, upright, uprightAxes } from "../projection";
import { bodyOf, type BodyLook } from "./bodies";
import { Boxes } from "./boxes";
import { colourAt } from "./colours";
import { Materials } from "./materials";
import { meshesOf, type Described, type Given } from "./meshes";

/** What is drawn. */
export interface Shown {
  /** Meshes of the description, where there are any. */
  meshes: boolean;
  aPriori: boolean;
  identified: boolean;
}

/** Vertical angle of view, degrees. */
const VIEW = 35;
/** Where the camera begins: about the vertical and above the horizon, rad. */
const START = { yaw: -0.95, pitch: 0.4 };
/** Largest angle above and below the horizon, rad. */
const STEEPEST = 1.5;
/** More pixels than this for one of the page cost time and show nothing. */
const FINEST = 2;
/** Without a graphics processor: the largest detail of meshes that is left out, parts of the robot's radius. */
const DETAIL = 1 / 100;

export class Scene {
  /** Pictures drawn since it was opened. */
  pictures = 0;
  private readonly renderer: WebGLRenderer;
  private readonly space = new Space();
  private readonly camera = new PerspectiveCamera(VIEW, 1, 0.01, 100);
  private readonly controls: OrbitControls;
  /** In the robot's own axes. */
  private readonly robot = new Group();
  private readonly links: Group[];
  private readonly base = new Group();
  private readonly boxes: Boxes;
  private readonly materials: Materials;
  private readonly bodies: Record<BodyLook, Group[]>;
  private meshes: Group[] = [];
  /** The joints whose links have all of their meshes; null is the base. */
  private meshed: ReadonlySet<number | null> = new Set();
  private shown: Shown = { meshes: true, aPriori: true, identified: true };
  private readonly radius: number;
  private request = 0;
  private isClosed = false;

  /** In a canvas; `isSlow` says that no graphics processor draws it. */
  constructor(private readonly canvas: HTMLCanvasElement, private readonly skeleton: Skeleton, private readonly isSlow: boolean) {
    this.renderer = new WebGLRenderer({ canvas, alpha: true, antialias: !isSlow });
    this.materials = new Materials(skeleton.joints.length);
    const ball = ballAround(upright(skeleton.frames, skeleton.gravity).flat());
    this.radius = Math.max(ball.radius, 1e-3);
    this.links = skeleton.joints.map(() => new Group());
    this.boxes = new Boxes(skeleton, 0.05 * this.radius, this.materials);
    this.bodies = { aPriori: this.bodiesOf(skeleton.bodies, "aPriori"), identified: [] };
    this.robot.applyMatrix4(matrixOf(uprightAxes(skeleton.gravity)));
    this.robot.add(this.base, this.boxes.group, ...this.links);
    this.space.add(this.robot, this.grid(), this.camera);
    this.light();
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableZoom = false;
    this.controls.maxPolarAngle = Math.PI / 2 + STEEPEST;
    this.controls.minPolarAngle = Math.PI / 2 - STEEPEST;
    this.controls.addEventListener("change", () => this.draw());
    this.look(new Vector3(...ball.centre));
    this.restyle();
    this.show(0);
  }

  /** Shows the moment of a number. */
  show(index: number): void {
    const [origins, rotations] = [this.skeleton.frames[index] ?? [], this.skeleton.rotations[index] ?? []];
    this.links.forEach((link, joint) => {
      link.quaternion.setFromRotationMatrix(matrixOf(rotations[joint]!));
      link.position.set(...origins[joint]!);
    });
    this.boxes.show(origins, rotations);
    this.draw();
  }

  /** Colours the link of each joint by a value from 0 to 1; null is without a colour. */
  paint(values: (number | null)[]): void {
    this.materials.paint(values.map((value) => (value === null ? null : new Color().setRGB(...colourAt(value), SRGBColorSpace))));
    this.draw();
  }

  /** Draws the bodies that were identified. */
  identify(bodies: LinkBody[]): void {
    for (const body of this.bodies.identified) body.removeFromParent();
    this.bodies.identified = this.bodiesOf(bodies, "identified");
    this.reveal(this.shown);
  }

  /** Shows and hides parts. */
  reveal(shown: Shown): void {
    this.shown = shown;
    for (const look of ["aPriori", "identified"] as const) this.bodies[look].forEach((body) => { body.visible = shown[look]; });
    for (const mesh of this.meshes) mesh.visible = shown.meshes;
    this.boxes.hide(shown.meshes ? this.meshed : new Set());
    this.draw();
  }

  /** Draws the meshes of a URDF from the files next to it, and says which are missing or cannot be read. */
  async describe(given: Given): Promise<Described> {
    const { links, described } = await meshesOf(given, this.skeleton, this.materials, this.isSlow ? DETAIL * this.radius : null);
    if (this.isClosed) return described;
    this.meshes.forEach(remove);
    this.meshes = links.map(({ joint, group }) => {
      (joint === null ? this.base : this.links[joint]!).add(group);
      return group;
    });
    this.meshed = described.links;
    this.reveal(this.shown);
    if (this.meshes.length > 0) this.fit();
    return described;
  }

  /** Turns the camera about the robot by angles, rad: to the left, and up. */
  turn(yaw: number, pitch: number): void {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const level = Math.hypot(offset.x, offset.y);
    const [about, above] = [Math.atan2(offset.y, offset.x) + yaw, Math.atan2(offset.z, level) + pitch];
    this.place(about, Math.max(-STEEPEST, Math.min(STEEPEST, above)), offset.length());
  }

  /** Comes nearer by a factor below one, and goes away by one above. */
  zoom(factor: number): void {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const length = Math.max(0.2 * this.radius, Math.min(40 * this.radius, offset.length() * factor));
    this.camera.position.copy(this.controls.target).add(offset.setLength(length));
    this.controls.update();
    this.draw();
  }

  /** Whether wheel and pinch zoom: the page scrolls until the drawing has the focus. */
  setZoom(isOn: boolean): void {
    this.controls.enableZoom = isOn;
  }

  /** Fits the picture into its place on the page. */
  resize(width: number, height: number): void {
    this.renderer.setPixelRatio(this.isSlow ? 1 : Math.min(devicePixelRatio, FINEST));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / Math.max(height, 1);
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  /** Takes the colours of the page. */
  restyle(): void {
    const style = getComputedStyle(this.canvas);
    this.materials.restyle((name) => style.getPropertyValue(`--${name}`).trim());
    this.draw();
  }

  close(): void {
    this.isClosed = true;
    cancelAnimationFrame(this.request);
    this.controls.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }

  private draw(): void {
    if (this.request !== 0 || this.isClosed) return;
    this.request = requestAnimationFrame(() => {
      this.request = 0;
      this.pictures += 1;
      this.renderer.render(this.space, this.camera);
    });
  }

  private bodiesOf(bodies: LinkBody[], look: BodyLook): Group[] {
    const drawn: Group[] = [];
    for (const { joint: name, body } of bodies) {
      const joint = this.skeleton.joints.findIndex((one) => one.name === name);
      if (joint < 0 || !body) continue;
      const group = bodyOf(body, look, this.materials);
      this.links[joint]!.add(group);
      drawn.push(group);
    }
    return drawn;
  }

  private grid(): Group {
    const heights = upright(this.skeleton.frames, this.skeleton.gravity).flat().map(([, , z]) => z);
    const ground = new GridHelper(3 * this.radius, 12);
    ground.material = this.materials.grid;
    ground.rotation.x = Math.PI / 2;
    ground.position.z = heights.reduce((a, b) => Math.min(a, b), 0);
    return new Group().add(ground);
  }

  private light(): void {
    const lamp = new DirectionalLight(0xffffff, 2);
    lamp.position.set(0.5, 1, 0.5);
    this.camera.add(lamp);
    this.space.add(new HemisphereLight(0xffffff, 0x8899aa, 1.6));
  }

  /** Looks at a centre from the first direction, as far away as the robot needs. */
  private look(centre: Vector3): void {
    this.camera.up.set(0, 0, 1);
    this.camera.near = 0.01 * this.radius;
    this.camera.far = 100 * this.radius;
    this.controls.target.copy(centre);
    this.place(START.yaw, START.pitch, (1.15 * this.radius) / Math.sin((VIEW * Math.PI) / 360));
  }

  /** Looks at the whole of the meshes. */
  private fit(): void {
    this.robot.updateMatrixWorld(true);
    const box = new Box3();
    for (const mesh of this.meshes) box.expandByObject(mesh);
    if (box.isEmpty()) return;
    const length = (0.62 * box.getSize(new Vector3()).length()) / Math.sin((VIEW * Math.PI) / 360);
    box.getCenter(this.controls.target);
    this.place(START.yaw, START.pitch, length);
  }

  private place(yaw: number, pitch: number, length: number): void {
    const direction = new Vector3(Math.cos(yaw) * Math.cos(pitch), Math.sin(yaw) * Math.cos(pitch), Math.sin(pitch));
    this.camera.position.copy(this.controls.target).addScaledVector(direction, length);
    this.controls.update();
    this.draw();
  }
}

/** Takes a group from the space, and its surfaces from the graphics memory. */
function remove(group: Group): void {
  group.removeFromParent();
  group.traverse((part) => { if (part instanceof Mesh) (part.geometry as BufferGeometry).dispose(); });
}

/** A rotation of three rows. */
function matrixOf([x, y, z]: Rotation): Matrix4 {
  return new Matrix4().set(...x, 0, ...y, 0, ...z, 0, 0, 0, 0, 1);
}
