// What the parts of the robot are made of: one material for each link, so that one change colours all of its parts.

import { Color, DoubleSide, LineBasicMaterial, MeshLambertMaterial } from "three";

/** How transparent meshes are where bodies are drawn inside them. */
const SEEN_THROUGH = 0.35;

export class Materials {
  /** Of the base. */
  readonly base = new MeshLambertMaterial({ side: DoubleSide });
  readonly identified = new MeshLambertMaterial({ transparent: true, opacity: 0.5, depthWrite: false });
  readonly aPriori = new LineBasicMaterial({ transparent: true, opacity: 0.5, depthWrite: false });
  readonly grid = new LineBasicMaterial();
  /** Of each link's boxes. */
  private readonly boxes: MeshLambertMaterial[];
  /** Of each link's meshes. */
  private readonly meshes: MeshLambertMaterial[];
  private readonly plain = new Color();
  private painted: (Color | null)[];

  constructor(joints: number) {
    const own = () => Array.from({ length: joints }, () => new MeshLambertMaterial({ side: DoubleSide, forceSinglePass: true }));
    [this.boxes, this.meshes, this.painted] = [own(), own(), Array.from({ length: joints }, () => null)];
  }

  /** Of a link's boxes; null is the base. */
  ofBox(joint: number | null): MeshLambertMaterial {
    return joint === null ? this.base : this.boxes[joint]!;
  }

  /** Of a link's meshes. */
  ofMesh(joint: number | null): MeshLambertMaterial {
    return joint === null ? this.base : this.meshes[joint]!;
  }

  paint(colours: (Color | null)[]): void {
    this.painted = colours;
    for (const materials of [this.boxes, this.meshes]) {
      materials.forEach((material, joint) => material.color.copy(this.painted[joint] ?? this.plain));
    }
  }

  setTransparent(isTransparent: boolean): void {
    for (const material of this.meshes) {
      material.transparent = isTransparent;
      material.opacity = isTransparent ? SEEN_THROUGH : 1;
      material.depthWrite = !isTransparent;
      material.needsUpdate = true;
    }
  }

  /** Takes the page's colours by their names. */
  restyle(of: (name: string) => string): void {
    this.plain.set(of("measured"));
    this.base.color.set(of("soft"));
    this.identified.color.set(of("didim"));
    this.aPriori.color.set(of("ink"));
    this.grid.color.set(of("rule"));
    this.paint(this.painted);
  }
}
