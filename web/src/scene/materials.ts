// What the parts of the robot are made of: one material for each link, so that one change colours all of its parts.

import { Color, DoubleSide, LineBasicMaterial, MeshLambertMaterial } from "three";

/** Bodies lie inside the links: they are drawn over them, half transparent. */
const INSIDE = { transparent: true, opacity: 0.5, depthTest: false, depthWrite: false };

export class Materials {
  /** Of the base. */
  readonly base = new MeshLambertMaterial({ side: DoubleSide });
  readonly identified = new MeshLambertMaterial(INSIDE);
  readonly aPriori = new LineBasicMaterial(INSIDE);
  readonly grid = new LineBasicMaterial();
  private readonly links: MeshLambertMaterial[];
  private readonly plain = new Color();
  private painted: (Color | null)[];

  constructor(joints: number) {
    this.links = Array.from({ length: joints }, () => new MeshLambertMaterial({ side: DoubleSide }));
    this.painted = Array.from({ length: joints }, () => null);
  }

  /** Of a joint's link; null is the base. */
  of(joint: number | null): MeshLambertMaterial {
    return joint === null ? this.base : this.links[joint]!;
  }

  paint(colours: (Color | null)[]): void {
    this.painted = colours;
    this.links.forEach((material, joint) => material.color.copy(this.painted[joint] ?? this.plain));
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
