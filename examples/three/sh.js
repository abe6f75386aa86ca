// Real spherical harmonics without the Condon–Shortley phase, z polar, Y_lm at l(l+1)+m: see docs/conventions.md.

/** All of degree below `order` at a unit direction. */
export function harmonics(order, [x, y, z]) {
  const values = new Array(order ** 2);
  // Normalised associated Legendre functions without their factor sin^m θ, which is in sin^m θ · (cos mφ, sin mφ).
  let [cos, sin, first] = [1, 0, Math.sqrt(1 / (4 * Math.PI))];
  for (let m = 0; m < order; m++) {
    let [before, p] = [0, first];
    for (let l = m; l < order; l++) {
      values[l * (l + 1) - m] = Math.SQRT2 * p * sin;
      values[l * (l + 1) + m] = (m > 0 ? Math.SQRT2 : 1) * p * cos;
      const a = (j) => Math.sqrt((4 * j * j - 1) / (j * j - m * m));
      [before, p] = [p, a(l + 1) * (z * p - (l > m ? before / a(l) : 0))];
    }
    first *= Math.sqrt((2 * m + 3) / (2 * m + 2));
    [cos, sin] = [x * cos - y * sin, x * sin + y * cos];
  }
  return values;
}

/** Directions and weights that integrate products of two functions of this order exactly: Fejér's rule by equal steps of longitude. */
function quadrature(order) {
  const count = 2 * order - 1;
  const nodes = [];
  for (let i = 0; i < count; i++) {
    const theta = (Math.PI * (i + 0.5)) / count;
    let weight = 1;
    for (let j = 1; j < order; j++) weight -= (2 * Math.cos(2 * j * theta)) / (4 * j * j - 1);
    for (let k = 0; k < count; k++) {
      const phi = (2 * Math.PI * k) / count;
      const d = [Math.sin(theta) * Math.cos(phi), Math.sin(theta) * Math.sin(phi), Math.cos(theta)];
      nodes.push({ d, weight: ((2 * weight) / count) * ((2 * Math.PI) / count) });
    }
  }
  return nodes;
}

/**
 * Turns light about the vertical axis: a function from radians to rows [r, g, b]. Light is summed up along every direction of a quadrature, turned back,
 * and projected again; that is exact to rounding. `rows` are cut, or filled up with darkness, to `order`.
 */
export function turning(rows, order) {
  const given = Array.from({ length: order ** 2 }, (_, i) => rows[i] ?? [0, 0, 0]);
  const nodes = quadrature(order).map(({ d, weight }) => ({ d, scaled: harmonics(order, d).map((value) => value * weight) }));
  return (angle) => {
    const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
    const turned = given.map(() => [0, 0, 0]);
    for (const { d: [x, y, z], scaled } of nodes) {
      const from = harmonics(order, [cos * x - sin * z, y, sin * x + cos * z]);
      const radiance = [0, 1, 2].map((c) => given.reduce((sum, rgb, i) => sum + rgb[c] * from[i], 0));
      turned.forEach((rgb, i) => radiance.forEach((value, c) => (rgb[c] += value * scaled[i])));
    }
    return turned;
  };
}
