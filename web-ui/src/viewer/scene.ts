/** The picture of a path: three.js for camera and bed, one instanced quad a move for the path. */

import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DataTexture,
  GLSL3,
  InstancedBufferGeometry,
  InstancedInterleavedBuffer,
  InterleavedBufferAttribute,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  PerspectiveCamera,
  RawShaderMaterial,
  Scene,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { Colouring } from "./colours";
import { JUMP, PRINT, type Toolpath } from "./toolpath";

export interface Box {
  min: [number, number];
  max: [number, number];
}

export interface Shown {
  first: number;
  last: number;
  travel: boolean;
  picked: number;
  hidden: ReadonlySet<number>;
}

const THREAD_MM = 0.42; // width at which a move that prints is drawn
const TRAVEL_MM = 0.12;
const GRID_MM = 10; // of the bed
const BESIDE = /custom|skirt|brim|wipe|prime|^other$/i;
const REACH_PX = 8; // around the pointer
const SLICE = 8192; // moves that are drawn at once
const STRIDE = 8; // between the slices that are drawn first
const FRAME_MS = 24; // of drawing, until the browser has its turn

const VERTEX = `
precision highp float;
uniform mat4 viewMatrix, projectionMatrix;
uniform vec3 origin;
uniform float unit, pixel;
uniform vec2 size;
uniform int first, picked;
uniform bool travels;
uniform sampler2D palette;
uniform vec4 travelColour, pickedColour;
in vec3 position;
in vec4 begin, end;
in float value;
out vec4 colour;
out float across, shade;
void main() {
  float kind = mod(end.w, 256.0);
  bool prints = kind > 1.5;
  vec4 tint = texelFetch(palette, ivec2(int(value + 0.5), 0), 0);
  if (gl_InstanceID < first || kind < 0.5 || (prints ? tint.a < 0.5 : !travels)) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    return;
  }
  vec4 a = projectionMatrix * viewMatrix * vec4(origin + unit * begin.xyz, 1.0);
  vec4 b = projectionMatrix * viewMatrix * vec4(origin + unit * end.xyz, 1.0);
  vec4 here = position.x < 0.5 ? a : b;
  vec2 along = (b.xy / b.w - a.xy / a.w) * size;
  float far = length(along);
  along = far > 1e-4 ? along / far : vec2(1.0, 0.0);
  bool marked = gl_InstanceID == picked;
  float wide = prints ? ${THREAD_MM} : ${TRAVEL_MM};
  float half_px = max(wide * pixel / here.w, marked ? 2.5 : prints ? 0.6 : 0.5);
  vec2 shift = vec2(-along.y, along.x) * position.y;
  if (prints) shift += along * (position.x < 0.5 ? -1.0 : 1.0);
  here.xy += shift * half_px * 2.0 / size * here.w;
  if (marked) here.z -= 0.002 * here.w;
  gl_Position = here;
  vec2 way = unit * (end.xy - begin.xy);
  float turned = dot(way, way) > 0.0 ? abs(dot(normalize(way), vec2(0.83, 0.56))) : 0.5;
  shade = prints && !marked ? 0.72 + 0.28 * turned : 1.0;
  across = prints && half_px > 1.0 ? position.y : 0.0;
  colour = marked ? pickedColour : prints ? vec4(tint.rgb, 1.0) : travelColour;
}`;

const FRAGMENT = `
precision mediump float;
in vec4 colour;
in float across, shade;
out vec4 shown;
void main() {
  float lit = 0.62 + 0.38 * sqrt(1.0 - min(across * across, 1.0));
  shown = vec4(colour.rgb * lit * shade, colour.a);
}`;

/** Slices in the order in which they are drawn: every eighth first, so that even a part of them shows
 * the shape. */
export function sliceOrder(count: number): number[] {
  const all = Array.from({ length: count }, (_, index) => index);
  return Array.from({ length: STRIDE }, (_, first) => all.filter((index) => index % STRIDE === first)).flat();
}

/** The corners of what is printed, without what is beside the part. */
function extent(path: Toolpath): [Vector3, Vector3] {
  const beside = new Set(path.header.features.flatMap((name, index) => (BESIDE.test(name) ? [index] : [])));
  if (path.header.features.length - beside.size <= 1) beside.clear(); // all but `other`
  const [low, high] = [new Vector3(Infinity, Infinity, Infinity), new Vector3(-Infinity, -Infinity, -Infinity)];
  const point = new Vector3();
  const step = Math.max(1, Math.floor(path.rows / 200_000));
  for (let row = 0; row < path.rows; row += step) {
    if (path.kind(row) !== PRINT || beside.has(path.value("feature", row))) continue;
    point.set(path.mm(row, 0), path.mm(row, 1), path.mm(row, 2));
    low.min(point);
    high.max(point);
  }
  return [low, high];
}

/** A path is drawn in slices, some in each frame: a renderer that is slow for all of them shows a part
 * of them at once, and answers to the mouse. */
export class PathScene {
  readonly #renderer: WebGLRenderer;
  readonly #scene = new Scene();
  readonly #camera = new PerspectiveCamera(40, 1, 1, 5000);
  readonly #controls: OrbitControls;
  #bed: LineSegments | undefined;
  #mesh: Mesh<InstancedBufferGeometry, RawShaderMaterial> | undefined;
  readonly #alone = new Scene(); // the path without the bed
  #slices: InstancedBufferGeometry[] = [];
  /** The slices that this picture still lacks. */
  #left: number[] = [];
  #begun = false;
  #triangles = 0;
  #path: Toolpath | undefined;
  #palette = new DataTexture(new Uint8Array(256 * 4), 256, 1);
  #colouring: Colouring | undefined;
  #box: Box = { min: [0, 0], max: [200, 200] };
  #waiting = 0;
  #shown: Shown = { first: 0, last: 0, travel: false, picked: -1, hidden: new Set() };

  /** Throws without WebGL 2. */
  constructor(readonly canvas: HTMLCanvasElement) {
    this.#renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, powerPreference: "high-performance", preserveDrawingBuffer: true });
    this.#renderer.autoClear = false;
    this.#renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.#camera.up.set(0, 0, 1);
    this.#controls = new OrbitControls(this.#camera, canvas);
    this.#controls.addEventListener("change", () => this.draw());
  }

  dispose(): void {
    cancelAnimationFrame(this.#waiting);
    this.#controls.dispose();
    this.#removePath();
    this.#bed?.geometry.dispose();
    this.#palette.dispose();
    this.#renderer.dispose();
  }

  resize(width: number, height: number): void {
    if (!width || !height) return;
    this.#renderer.setSize(width, height, false);
    this.#camera.aspect = width / height;
    this.#camera.updateProjectionMatrix();
    this.draw();
  }

  setBed(box: Box, colour: string): void {
    this.#box = box;
    this.#bed?.geometry.dispose();
    if (this.#bed) this.#scene.remove(this.#bed);
    const [[x0, y0], [x1, y1]] = [box.min, box.max];
    const ends: number[] = [];
    const line = (...points: number[]) => ends.push(...points);
    for (let x = Math.ceil(x0 / GRID_MM) * GRID_MM; x <= x1; x += GRID_MM) line(x, y0, 0, x, y1, 0);
    for (let y = Math.ceil(y0 / GRID_MM) * GRID_MM; y <= y1; y += GRID_MM) line(x0, y, 0, x1, y, 0);
    line(x0, y0, 0, x1, y0, 0, x1, y0, 0, x1, y1, 0, x1, y1, 0, x0, y1, 0, x0, y1, 0, x0, y0, 0);
    const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(ends), 3));
    this.#bed = new LineSegments(geometry, new LineBasicMaterial({ color: new Color(colour) }));
    this.#bed.position.z = -0.05;
    this.#scene.add(this.#bed);
    this.draw();
  }

  setPath(path: Toolpath): void {
    this.#removePath();
    this.#path = path;
    const corners = new BufferAttribute(new Float32Array([0, -1, 0, 1, -1, 0, 0, 1, 0, 1, 1, 0]), 3);
    // One buffer gives both ends of a move: that of its row, and that of the row before.
    const rows = new InstancedInterleavedBuffer(path.column("at") as Uint16Array, 4, 1);
    for (let first = 0; first < path.rows - 1; first += SLICE) {
      const geometry = new InstancedBufferGeometry();
      geometry.setAttribute("position", corners);
      geometry.setIndex([0, 1, 2, 2, 1, 3]);
      geometry.setAttribute("begin", new InterleavedBufferAttribute(rows, 4, 4 * first));
      geometry.setAttribute("end", new InterleavedBufferAttribute(rows, 4, 4 * (first + 1)));
      this.#slices.push(geometry);
    }
    const { origin_mm, unit_mm } = path.header;
    const material = new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: {
        origin: { value: new Vector3(...origin_mm) },
        unit: { value: unit_mm },
        pixel: { value: 1 },
        size: { value: new Vector2(1, 1) },
        first: { value: 0 },
        picked: { value: -1 },
        travels: { value: false },
        palette: { value: this.#palette },
        travelColour: { value: [0.5, 0.55, 0.62, 1] },
        pickedColour: { value: [1, 1, 1, 1] },
      },
    });
    this.#mesh = new Mesh(new InstancedBufferGeometry(), material);
    this.#mesh.frustumCulled = false;
    this.#alone.add(this.#mesh);
    this.look("angle");
  }

  #removePath(): void {
    for (const geometry of this.#slices) geometry.dispose();
    this.#slices = [];
    if (!this.#mesh) return;
    this.#alone.remove(this.#mesh);
    this.#mesh.material.dispose();
    this.#mesh = undefined;
  }

  setColours(colouring: Colouring, picked: string): void {
    this.#colouring = colouring;
    const mesh = this.#mesh;
    if (!mesh) return;
    const values = new InstancedInterleavedBuffer(colouring.values, 1, 1);
    this.#slices.forEach((geometry, index) =>
      geometry.setAttribute("value", new InterleavedBufferAttribute(values, 1, index * SLICE + 1)),
    );
    const marked = new Color(picked);
    mesh.material.uniforms["pickedColour"]!.value = [marked.r, marked.g, marked.b, 1];
    this.show(this.#shown);
  }

  show(shown: Shown): void {
    this.#shown = shown;
    const mesh = this.#mesh;
    const colouring = this.#colouring;
    if (!mesh || !colouring) return;
    const data = this.#palette.image.data as Uint8Array;
    colouring.palette.forEach((colour, index) => data.set([...colour, shown.hidden.has(index) ? 0 : 255], index * 4));
    this.#palette.needsUpdate = true;
    mesh.material.uniforms["travels"]!.value = shown.travel;
    this.draw();
  }

  look(from: "angle" | "top" | "front"): void {
    const [x0, y0] = this.#box.min;
    const [x1, y1] = this.#box.max;
    const target = new Vector3((x0 + x1) / 2, (y0 + y1) / 2, 0);
    let reach = Math.max(x1 - x0, y1 - y0);
    if (this.#path) {
      const [low, high] = extent(this.#path);
      if (low.x <= high.x) {
        target.addVectors(low, high).multiplyScalar(0.5);
        reach = Math.max(high.distanceTo(low), 20);
      }
    }
    const ways = { angle: [-0.35, -0.8, 0.6], top: [0, -0.001, 1], front: [0, -1, 0.08] } as const;
    const narrow = Math.max(1, 1 / this.#camera.aspect); // a window that is higher than wide
    const away = new Vector3(...ways[from]).normalize().multiplyScalar(reach * 1.5 * narrow);
    this.#camera.position.addVectors(target, away);
    this.#camera.near = Math.max(reach / 200, 0.1);
    this.#camera.far = reach * 20 + 1000;
    this.#camera.updateProjectionMatrix();
    this.#controls.target.copy(target);
    this.#controls.update();
    this.draw();
  }

  /** Begins the picture again, with the next frame of the browser. */
  draw(): void {
    this.#begun = false;
    this.#continue();
  }

  #continue(): void {
    if (this.#waiting) return;
    this.#waiting = requestAnimationFrame(() => {
      this.#waiting = 0;
      if (!this.#begun) this.#begin();
      const until = performance.now() + FRAME_MS;
      while (this.#left.length && performance.now() < until) {
        this.#drawSlice(this.#left.shift() ?? 0);
        if (this.#left.length) this.#wait();
      }
      this.canvas.dataset["triangles"] = String(this.#triangles); // for tests and the bench
      if (this.#left.length) this.#continue();
    });
  }

  /** The bed, and which slices follow. */
  #begin(): void {
    this.#begun = true;
    this.#triangles = 0;
    const { first, last } = this.#shown;
    const order = this.#colouring ? sliceOrder(this.#slices.length) : [];
    this.#left = order.filter((index) => index * SLICE < last - 1 && (index + 1) * SLICE >= first - 1);
    this.#renderer.clear();
    this.#renderer.render(this.#scene, this.#camera);
    const size = this.#renderer.getDrawingBufferSize(new Vector2());
    const uniforms = this.#mesh?.material.uniforms;
    if (!uniforms) return;
    uniforms["size"]!.value = size;
    // Half a millimetre at distance 1, in pixels.
    uniforms["pixel"]!.value = (size.y / 2 / Math.tan((this.#camera.fov * Math.PI) / 360)) * 0.5;
  }

  #drawSlice(index: number): void {
    const [mesh, geometry] = [this.#mesh, this.#slices[index]];
    if (!mesh || !geometry) return;
    const before = index * SLICE;
    const { first, last, picked } = this.#shown;
    // An instance is a move between two rows: there is one less.
    geometry.instanceCount = Math.min(SLICE, last - 1 - before);
    mesh.geometry = geometry;
    mesh.material.uniforms["first"]!.value = Math.max(0, first - 1 - before);
    mesh.material.uniforms["picked"]!.value = picked - 1 - before;
    mesh.material.uniformsNeedUpdate = true;
    this.#renderer.render(this.#alone, this.#camera);
    this.#triangles += this.#renderer.info.render.triangles;
  }

  /** Until the renderer has drawn: otherwise it would queue all slices, for as long as they take. */
  #wait(): void {
    const gl = this.#renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  }

  /** The row of the nearest move that is drawn at a point of the canvas, or -1. */
  pick(x: number, y: number): number {
    const path = this.#path;
    if (!path) return -1;
    const { width, height } = this.canvas.getBoundingClientRect();
    this.#camera.updateMatrixWorld();
    const m = this.#camera.projectionMatrix.clone().multiply(this.#camera.matrixWorldInverse).elements as number[];
    const [m0, m1, m3, m4, m5, m7, m8, m9, m11, m12, m13, m15] = [0, 1, 3, 4, 5, 7, 8, 9, 11, 12, 13, 15].map(
      (i) => m[i] ?? 0,
    ) as [number, number, number, number, number, number, number, number, number, number, number, number];
    const at = path.column("at");
    const { origin_mm, unit_mm } = path.header;
    const { first, last, travel, hidden } = this.#shown;
    let [best, bestDepth] = [-1, Infinity];
    let [bx, by, bw] = [0, 0, -1];
    for (let row = Math.max(first - 1, 0); row < last; row++) {
      const px = origin_mm[0] + unit_mm * (at[row * 4] ?? 0);
      const py = origin_mm[1] + unit_mm * (at[row * 4 + 1] ?? 0);
      const pz = origin_mm[2] + unit_mm * (at[row * 4 + 2] ?? 0);
      const w = m3 * px + m7 * py + m11 * pz + m15;
      const sx = (((m0 * px + m4 * py + m8 * pz + m12) / w + 1) * width) / 2;
      const sy = ((1 - (m1 * px + m5 * py + m9 * pz + m13) / w) * height) / 2;
      const kind = (at[row * 4 + 3] ?? 0) & 255;
      const drawn = kind === PRINT ? !hidden.has(this.#colouring?.values[row] ?? 0) : travel && kind !== JUMP;
      if (drawn && w > 0 && bw > 0 && row > first - 1) {
        const [dx, dy] = [sx - bx, sy - by];
        const long = dx * dx + dy * dy;
        const part = long ? Math.min(Math.max(((x - bx) * dx + (y - by) * dy) / long, 0), 1) : 0;
        const off = Math.hypot(x - bx - dx * part, y - by - dy * part);
        if (off < REACH_PX) {
          const depth = bw + (w - bw) * part + off * 0.05;
          if (depth < bestDepth) [best, bestDepth] = [row, depth];
        }
      }
      [bx, by, bw] = [sx, sy, w];
    }
    return best;
  }
}
