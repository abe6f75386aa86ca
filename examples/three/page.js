// Loads what the address names: ?asset=out.glb&light=light.json, and where wanted &eye=X,Y,Z&target=X,Y,Z&fov=DEG&exposure=STOPS&turn=DEG.
// Without `turn` the light goes round.
import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { relight } from "./relight.js";
import { turning } from "./sh.js";

const given = new URLSearchParams(location.search);
const point = (name) => given.has(name) && new THREE.Vector3(...given.get(name).split(",").map(Number));

// The tone map of `relume render` [narkowicz2016]: three does the sRGB encoding after it.
THREE.ShaderChunk.tonemapping_pars_fragment = THREE.ShaderChunk.tonemapping_pars_fragment.replace(
  "vec3 CustomToneMapping( vec3 color ) { return color; }",
  `vec3 CustomToneMapping(vec3 color) {
    vec3 x = max(color * toneMappingExposure, 0.0);
    return min(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 1.0);
  }`,
);

/** A camera that sees all of the scene, or stands where the address says. */
function camera(scene) {
  const ball = new THREE.Box3().setFromObject(scene).getBoundingSphere(new THREE.Sphere());
  const fov = Number(given.get("fov") ?? 35);
  const away = ball.radius / Math.sin((fov * Math.PI) / 360);
  const camera = new THREE.PerspectiveCamera(fov, innerWidth / innerHeight, away / 1e3, away * 1e2);
  const target = point("target") || ball.center;
  camera.position.copy(point("eye") || new THREE.Vector3(0.5, 0.4, 0.8).setLength(away).add(target));
  camera.lookAt(target);
  return { camera, target };
}

async function start() {
  const renderer = new THREE.WebGLRenderer();
  renderer.setSize(innerWidth, innerHeight);
  renderer.toneMapping = THREE.CustomToneMapping;
  renderer.toneMappingExposure = 0.6 * 2 ** Number(given.get("exposure") ?? 0);
  const [gltf, file] = await Promise.all([
    new GLTFLoader().loadAsync(given.get("asset") ?? "out.glb"),
    fetch(given.get("light") ?? "light.json").then((response) => response.json()),
  ]);
  if (file.basis !== "sh" || file.convention !== "real-no-cs") throw new Error("not a light of `relume light`");
  const scene = new THREE.Scene().add(gltf.scene);
  const { order, setLight } = await relight(gltf, renderer);
  const turned = turning(file.coefficients, order);
  const view = camera(scene);
  const controls = new OrbitControls(view.camera, renderer.domElement);
  controls.target.copy(view.target);
  controls.update();
  addEventListener("resize", () => {
    renderer.setSize(innerWidth, innerHeight);
    view.camera.aspect = innerWidth / innerHeight;
    view.camera.updateProjectionMatrix();
  });
  const draw = (milliseconds) => {
    const degrees = Number(given.get("turn") ?? milliseconds * 0.03);
    setLight(turned((degrees * Math.PI) / 180));
    renderer.render(scene, view.camera);
  };
  renderer.setAnimationLoop(draw);
  document.body.append(renderer.domElement);
  document.querySelector("#message").remove();
  // For a script that looks at the picture: what WebGL draws is gone once the browser has shown it.
  window.draw = draw;
}

start().catch((error) => {
  document.querySelector("#message").textContent = error.message;
  console.error(error);
});
