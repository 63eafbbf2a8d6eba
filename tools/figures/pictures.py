# SPDX-License-Identifier: Apache-2.0
"""All pictures by name: functions of the repository's root."""
import bus
import bvh
import card
import charts
import pairs
import pass_time
import pipe
import runs
import scenes
import software
import solid_shapes

ALL = {
    "card": card.card,
    "pass": pass_time.picture,
    "shapes": solid_shapes.picture,
    "traversal": bvh.traversal,
    "bvh_bound": bvh.bound,
    "node_test": bvh.node_test,
    "node_cache": bvh.node_cache,
    "pipe": pipe.moeller,
    "pipe_spheres": pipe.spheres,
    "bus": bus.picture,
    "pairs_rays": pairs.rays,
    "pairs_convex": pairs.convex,
    "pairs_cylinder": pairs.cylinder,
    "scene_frame": scenes.frame,
    "scene_keys": scenes.keys,
    "inside": scenes.inside,
    "rays": scenes.rays,
    "shards": runs.shards,
    "explain": runs.explain,
    "filter": runs.filters,
    "layers": software.layers,
    "programs": software.programs,
    "outputs": software.outputs,
    "trust": software.trust,
    "tiers": software.tiers,
    "first_steps": software.first_steps,
    "accuracy": charts.accuracy,
    "costs": charts.costs,
    "stability": charts.stability,
    "reproduction": charts.reproduction,
}
