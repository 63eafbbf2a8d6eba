// SPDX-License-Identifier: Apache-2.0
// OpenCL C 1.2. Nearest hits of rays at triangles, by brute force and through a binary BVH, and
// overlaps of spheres. baseline_opencl.cpp compiles it at run time for the chosen device.
//
// Operations have the order and roundings of reference/pipes/ray_triangle.hpp (moller, box rule).
// So T has the card's bits where the device divides with correct rounding and keeps subnormals.
#pragma OPENCL FP_CONTRACT OFF

#define NONE 0xffffffffu
#define UNIT 0x1p-24f // unit roundoff of fp32
#define STACK 64      // levels that a BVH may have

typedef struct {
  float4 v0, v1, v2; // v0.w: index as bits
} Triangle;

// Two children. Per axis: low and high of the first box, low and high of the second box. A child is
// its number * 8 + count: count 0 is a node, otherwise a leaf with so many triangles.
typedef struct {
  float4 x, y, z;
  uint4 child;
} Node;

typedef struct {
  float t;
  uint index;
} Hit;

typedef struct {
  float3 o, d;
  float tmin, tmax;
} Ray;

static Ray ray_at(global const float4* rays, uint i) {
  const float4 a = rays[2 * i], b = rays[2 * i + 1];
  Ray r;
  r.o = a.xyz, r.d = (float3)(a.w, b.x, b.y), r.tmin = b.z, r.tmax = b.w;
  return r;
}

static float3 cross_of(float3 a, float3 b) {
  return (float3)(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static float dot_of(float3 a, float3 b) { return (a.x * b.x + a.y * b.y) + a.z * b.z; }
static float move_sign(float x, float y) {
  return as_float(as_uint(y) ^ (as_uint(x) & 0x80000000u));
}

static bool flat_axis(float3 a, float3 b, float3 c, float3 d) {
  const float3 p = a * b, q = c * d;
  const float3 sum = ((fabs(p) + 0x1p-126f) + fabs(q)) * (4 * UNIT);
  const float3 size = fabs(p - q);
  return size.x <= sum.x && size.y <= sum.y && size.z <= sum.z;
}

// The box rule: whether o + t d lies in the box of the triangle (reference/pipes/ray_box.hpp).
static bool in_box(float3 a, float3 b, float3 c, float3 e1, float3 e2, float3 td, float3 p) {
  if (flat_axis(e1.yzx, e2.zxy, e1.zxy, e2.yzx)) return false;
  const float3 low = fmin(fmin(a, b), c), high = fmax(fmax(a, b), c);
  const float3 centre = (low + high) * 0.5f, half_size = high - centre;
  const float3 reach = fabs(centre) + half_size;
  const float world = fmax(fmax(reach.x, reach.y), reach.z) * (8 * UNIT);
  const float scaled = ((fabs(td.x) + fabs(td.y)) + fabs(td.z)) * (64 * UNIT);
  const float margin = isfinite(scaled) ? scaled : 0;
  const float3 off = fabs(p - centre) - (half_size + world);
  return off.x < margin && off.y < margin && off.z < margin;
}

// Keeps the triangle if it is hit nearer than `best`, or as near with a lower index.
static void test(const Ray* r, global const Triangle* triangle, Hit* best) {
  const float4 first = triangle->v0;
  const float3 a = first.xyz, b = triangle->v1.xyz, c = triangle->v2.xyz;
  const float3 e1 = b - a, e2 = c - a, tv = r->o - a;
  const float3 p = cross_of(r->d, e2);
  const float det = dot_of(p, e1), size = fabs(det);
  const float u = dot_of(p, tv), us = move_sign(det, u);
  if (!(0 <= us && us <= size && 0 < size)) return;
  const float3 q = cross_of(tv, e1);
  const float v = dot_of(q, r->d), vs = move_sign(det, v);
  if (!(0 <= vs && vs <= size && move_sign(det, u + v) <= size)) return;
  const float t = dot_of(q, e2) / det;
  const uint index = as_uint(first.w);
  if (!(r->tmin <= t && t <= r->tmax && isfinite(t))) return;
  if (!(t < best->t || (t == best->t && index < best->index))) return;
  const float3 td = r->d * t, cp = r->o + td;
  if (!(isfinite(cp.x) && isfinite(cp.y) && isfinite(cp.z))) return;
  if (!in_box(a, b, c, e1, e2, td, cp)) return;
  best->t = t == 0 ? 0 : t; // never -0
  best->index = index;
}

static Hit no_hit(void) {
  Hit none;
  none.t = INFINITY, none.index = NONE;
  return none;
}

// Work item i tests ray `first + i % count` against the triangles of chunk i / count: every
// `chunks`-th triangle. Neighbouring items have neighbouring rays and the same triangle.
kernel void brute_force(global const float4* rays, uint first, uint count, uint chunks,
                        global const Triangle* triangles, uint triangle_count,
                        global Hit* partial) {
  const uint i = get_global_id(0);
  if (i >= count * chunks) return;
  const Ray r = ray_at(rays, first + i % count);
  Hit best = no_hit();
  for (uint n = i / count; n < triangle_count; n += chunks) test(&r, triangles + n, &best);
  partial[i] = best;
}

// The nearest hit among the chunks of a ray.
kernel void nearest_chunk(global const Hit* partial, uint first, uint count, uint chunks,
                          global Hit* hits) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  Hit best = partial[i];
  for (uint k = 1; k < chunks; ++k) {
    const Hit hit = partial[k * count + i];
    if (hit.t < best.t || (hit.t == best.t && hit.index < best.index)) best = hit;
  }
  hits[first + i] = best;
}

// The part of the ray inside a child's box, as near and far T. The box is low.k, high.k on axis k.
static float2 inside(float3 low, float3 high, float3 o, float3 inverse, float margin) {
  const float3 a = ((low - o) - margin) * inverse, b = ((high - o) + margin) * inverse;
  const float3 near = fmin(a, b), far = fmax(a, b);
  return (float2)(fmax(fmax(near.x, near.y), near.z), fmin(fmin(far.x, far.y), far.z));
}

// One ray per work item. `low` and `high` are the box of all triangles. Boxes are widened by more
// than the box rule allows (docs/background/bvh_proof.md), so the result equals brute force:
//
//   256 u R + 16 u W > m' + 12 u R     m' < 192 u (R + m') (1 + 4 u) + 12 u W
//
// R is the largest distance along an axis from o to a corner, W the largest coordinate. A slab has
// two roundings, its product with 1 / d has two more. OpenCL may round 1 / d by 5 u.
kernel void traverse(global const float4* rays, uint count, global const Node* nodes,
                     global const Triangle* triangles, float4 low, float4 high,
                     global Hit* hits) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  const Ray r = ray_at(rays, i);
  const float3 reach = fmax(fabs(low.xyz - r.o), fabs(high.xyz - r.o));
  const float3 world = fmax(fabs(low.xyz), fabs(high.xyz));
  const float margin = fmax(fmax(reach.x, reach.y), reach.z) * (256 * UNIT) +
                       fmax(fmax(world.x, world.y), world.z) * (16 * UNIT) + 0x1p-126f;
  // A component below 2^-80 counts as 2^-80. The largest one is at least 2^-34.
  const float3 slope = copysign(fmax(fabs(r.d), (float3)(0x1p-80f)), r.d);
  const float3 inverse = 1.0f / slope;
  uint stack[STACK];
  float stack_near[STACK];
  int depth = 0;
  Hit best = no_hit();
  float limit = r.tmax;
  uint child = 0;
  while (true) {
    const uint at = child >> 3, triangle_count = child & 7;
    for (uint n = at; n < at + triangle_count; ++n) test(&r, triangles + n, &best);
    limit = fmin(limit, best.t);
    if (triangle_count == 0) {
      const Node node = nodes[at];
      const float2 a = inside((float3)(node.x.x, node.y.x, node.z.x),
                              (float3)(node.x.y, node.y.y, node.z.y), r.o, inverse, margin);
      const float2 b = inside((float3)(node.x.z, node.y.z, node.z.z),
                              (float3)(node.x.w, node.y.w, node.z.w), r.o, inverse, margin);
      const bool enters_a = a.x <= a.y && r.tmin <= a.y && a.x <= limit;
      const bool enters_b = b.x <= b.y && r.tmin <= b.y && b.x <= limit;
      const bool a_first = enters_a && (!enters_b || a.x <= b.x);
      if (enters_a && enters_b) {
        stack[depth] = a_first ? node.child.y : node.child.x;
        stack_near[depth++] = a_first ? b.x : a.x;
      }
      if (enters_a || enters_b) {
        child = a_first ? node.child.x : node.child.y;
        continue;
      }
    }
    do {
      if (depth == 0) {
        hits[i] = best;
        return;
      }
      child = stack[--depth];
    } while (stack_near[depth] > limit);
  }
}

// The number of spheres that overlap or touch sphere i, itself included. A sphere is centre, radius.
kernel void overlaps(global const float4* spheres, uint count, global uint* found) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  const float4 own = spheres[i];
  uint some = 0;
  for (uint n = 0; n < count; ++n) {
    const float4 other = spheres[n];
    const float3 d = other.xyz - own.xyz;
    const float sum = other.w + own.w;
    some += (d.x * d.x + d.y * d.y) + d.z * d.z <= sum * sum ? 1 : 0;
  }
  found[i] = some;
}
