// Forward kinematics: the tree of links, joints of one degree of freedom, mimicking joints.
// q holds the positions of all moving joints, u those of the independent ones.

import { IDENTITY, cross, minus, position, scaled, screw, times, turn } from "./vectors.js";

export class Tree {
  constructor(motion) {
    this.links = motion.links;
    this.linkIndex = new Map(motion.links.map((name, i) => [name, i]));
    this.joints = motion.joints.filter((joint) => joint.moves);
    this.column = new Map(this.joints.map((joint, i) => [joint.name, i]));
    this.independent = this.joints.filter((joint) => joint.leader === joint.name);
    this.row = new Map(this.independent.map((joint, i) => [joint.name, i]));
    this.leader = this.joints.map((joint) => this.row.get(joint.leader));
    this.above = motion.links.map(() => null);
    this.above[0] = [];
    this.steps = motion.joints.map((joint) => {
      const [parent, child] = [this.linkIndex.get(joint.parent), this.linkIndex.get(joint.child)];
      const column = joint.moves ? this.column.get(joint.name) : -1;
      this.above[child] = joint.moves ? [...this.above[parent], column] : this.above[parent];
      return { joint, parent, child, column };
    });
  }

  // Positions of all moving joints.
  follow(u) {
    return this.joints.map((joint, i) => joint.multiplier * u[this.leader[i]] + joint.offset);
  }

  // The configuration drawn in the CAD.
  drawn() {
    return this.independent.map((joint) => joint.drawn);
  }

  // X_WL of every link.
  frames(q) {
    const X = new Array(this.links.length);
    X[0] = IDENTITY;
    for (const { joint, parent, child, column } of this.steps) {
      X[child] = times(X[parent], joint.X);
      if (column >= 0) {
        X[child] = times(X[child], screw(joint.axis, joint.turn * q[column], joint.advance * q[column]));
      }
    }
    return X;
  }

  // The axis of each moving joint in the world, and the origin of its frame.
  lines(X) {
    const lines = new Array(this.joints.length);
    for (const { joint, child, column } of this.steps) {
      if (column >= 0) lines[column] = { axis: turn(X[child], joint.axis), origin: position(X[child]) };
    }
    return lines;
  }

  // Angular velocity and velocity of a point, in the world, per unit speed of a joint above it.
  twist(lines, column, point) {
    const { axis, origin } = lines[column];
    const joint = this.joints[column];
    const swept = scaled(cross(axis, minus(point, origin)), joint.turn);
    return [scaled(axis, joint.turn), [0, 1, 2].map((i) => swept[i] + joint.advance * axis[i])];
  }
}
