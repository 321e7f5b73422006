/** The spot that a fixture in hand makes, and the way of its light there: what is dragged to aim it. */

import {BufferAttribute, BufferGeometry, type Color, DoubleSide, Group, Line, LineBasicMaterial, Mesh, MeshBasicMaterial, RingGeometry, Vector3} from 'three';

const RING_M = [0.1, 0.15] as const;
const OFF_SURFACE_M = 0.01;

export class AimSpot {
  readonly group = new Group();
  place: Vector3|undefined;  // of the spot; undefined while nothing is in hand
  private readonly material = new MeshBasicMaterial({side: DoubleSide, depthTest: false, transparent: true});
  private readonly lineMaterial = new LineBasicMaterial({depthTest: false, transparent: true, opacity: 0.7});
  private readonly ring = new Mesh(new RingGeometry(...RING_M, 40), this.material);
  private readonly way = new BufferGeometry();

  constructor() {
    this.way.setAttribute('position', new BufferAttribute(new Float32Array(6), 3));
    const line = new Line(this.way, this.lineMaterial);
    line.frustumCulled = this.ring.frustumCulled = false;
    line.renderOrder = this.ring.renderOrder = 4;
    this.group.add(line, this.ring);
    this.group.visible = false;
  }

  setColour(colour: Color): void {
    this.material.color.copy(colour);
    this.lineMaterial.color.copy(colour);
  }

  show(lamp: Vector3, place: Vector3, normal: Vector3): void {
    this.place = place.clone();
    this.ring.position.copy(place).addScaledVector(normal, OFF_SURFACE_M);
    this.ring.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), normal);
    const ends = this.way.getAttribute('position') as BufferAttribute;
    ends.setXYZ(0, lamp.x, lamp.y, lamp.z);
    ends.setXYZ(1, place.x, place.y, place.z);
    ends.needsUpdate = true;
    this.group.visible = true;
  }

  hide(): void {
    this.place = undefined;
    this.group.visible = false;
  }
}
