// Relights the meshes of a baked asset: every vertex multiplies its transfer with the light's coefficients. Read docs/format.md beside it.
import * as THREE from "three";

/** What the file must say, or its numbers mean something else. */
const READ = { basis: "sh", convention: "real-no-cs", quantity: "irradiance-over-pi", colour: "linear-rec709", frame: "scene" };

/**
 * Gives every mesh of a loaded asset (what GLTFLoader returns) a material that is lit by its transfer. Returns the order, and a function
 * that sets the light: an array of at least order² rows [r, g, b] in the space of the scene's root.
 */
export async function relight(gltf, renderer) {
  const light = { value: [] };
  const uploads = new Map();
  let order;
  const meshes = [];
  gltf.scene.traverse((object) => object.isMesh && meshes.push(object));
  for (const mesh of meshes) {
    const extension = extensionOf(mesh);
    let entry = extension.primitives[gltf.parser.associations.get(mesh).primitives];
    while (entry.sameAs !== undefined) entry = extension.primitives[entry.sameAs];
    if (!uploads.has(entry.transfer)) uploads.set(entry.transfer, await upload(gltf.parser, entry, extension, renderer));
    const sides = uploads.get(entry.transfer);
    if (sides.backs) mesh.geometry = withBacks(mesh.geometry, sides.backs);
    mesh.material = lit(mesh.material, extension, sides, light);
    order = extension.order;
  }
  return { order, setLight: (rows) => (light.value = rows.slice(0, order ** 2).map((rgb) => new THREE.Vector3(...rgb))) };
}

/** The extension stands on the node: the mesh itself, or a group around the primitives of its mesh. */
function extensionOf(object) {
  const extension = object.userData.gltfExtensions?.RELUME_transfer;
  if (!extension) {
    if (!object.parent) throw new Error("this file has no baked transfer; make one with `relume bake`");
    return extensionOf(object.parent);
  }
  const unknown = Object.keys(READ).find((key) => extension[key] !== READ[key]);
  if (extension.version > 1 || unknown) throw new Error(`RELUME_transfer of an unknown kind: ${unknown ?? "version"}`);
  return extension;
}

/** The numbers as they are in the file, one to a texel, backs after fronts; and if there are backs, which of them each vertex has, or -1. */
async function upload(parser, { count, transfer, back }, { precision, order, channels }, renderer) {
  const view = (i) => parser.getDependency("bufferView", i);
  const Numbers = { f32: Float32Array, f16: Uint16Array }[precision];
  const type = { f32: THREE.FloatType, f16: THREE.HalfFloatType }[precision];
  const numbers = (count + (back?.count ?? 0)) * channels * order ** 2;
  const width = renderer.capabilities.maxTextureSize;
  const data = new Numbers(width * Math.ceil(numbers / width));
  data.set(new Numbers(await view(transfer)));
  const backs = back && new THREE.BufferAttribute(new Float32Array(count).fill(-1), 1);
  if (back) {
    data.set(new Numbers(await view(back.transfer)), count * channels * order ** 2);
    new Uint32Array(await view(back.vertices)).forEach((vertex, i) => backs.setX(vertex, count + i));
  }
  const texture = new THREE.DataTexture(data, width, data.length / width, THREE.RedFormat, type);
  texture.needsUpdate = true;
  return { texture, backs };
}

/** The same geometry with one attribute more. Other instances share the geometry and may have other backs. */
function withBacks({ index, attributes }, backs) {
  const geometry = new THREE.BufferGeometry().setIndex(index);
  geometry.attributes = { ...attributes, backs };
  return geometry;
}

/** The colours of a material (factor, texture, vertex colours, alpha mask), times what its transfer makes of light. */
function lit({ color, map, vertexColors, alphaTest }, { order, channels, albedo }, { texture, backs }, light) {
  // From behind, a surface of one side is black; three would leave it out.
  const material = new THREE.MeshBasicMaterial({ color, map, vertexColors, alphaTest, side: THREE.DoubleSide });
  material.defines = { COUNT: order ** 2, CHANNELS: channels };
  if (backs) material.defines.BACKS = 1;
  if (albedo) material.defines.ALBEDO = `vec3(${albedo.map((value) => value.toFixed(9))})`;
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, { transfer: { value: texture }, light });
    shader.vertexShader = TRANSFER + shader.vertexShader.replace("#include <project_vertex>", `$& ${RELIGHT}`);
    shader.fragmentShader =
      VARYINGS + shader.fragmentShader.replace("#include <alphatest_fragment>", `$& ${MULTIPLY}`);
  };
  return material;
}

const VARYINGS = `
varying vec3 front, behind;
`;

const TRANSFER = `${VARYINGS}
uniform highp sampler2D transfer;
uniform vec3 light[COUNT];
#ifdef BACKS
  attribute float backs;
#endif

float coefficient(int i) {
  int width = textureSize(transfer, 0).x;
  return texelFetch(transfer, ivec2(i % width, i / width), 0).r;
}

// Radiance of a side as if its albedo were 1: for each channel the dot product of transfer and light.
vec3 transferred(int side) {
  vec3 sum = vec3(0.0);
  for (int i = 0; i < COUNT; i++) {
    int first = side * CHANNELS * COUNT + i;
    vec3 t = vec3(coefficient(first));
    if (CHANNELS == 3) t.yz = vec2(coefficient(first + COUNT), coefficient(first + 2 * COUNT));
    sum += t * light[i];
  }
  return sum;
}
`;

const RELIGHT = `
front = transferred(gl_VertexID);
behind = vec3(0.0);
#ifdef BACKS
  if (backs >= 0.0) behind = transferred(int(backs));
#endif
`;

const MULTIPLY = `
#ifdef ALBEDO
  diffuseColor.rgb = ALBEDO;
#endif
diffuseColor.rgb *= gl_FrontFacing ? front : behind;
`;
