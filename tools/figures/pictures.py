# SPDX-License-Identifier: Apache-2.0
"""All pictures by name: functions of the repository's root."""
import bus
import card
import hierarchy
import pairs
import pass_time
import pipe
import solid_shapes

ALL = {
    "card": card.card,
    "pass": pass_time.picture,
    "shapes": solid_shapes.picture,
    "traversal": hierarchy.traversal,
    "bvh_bound": hierarchy.bound,
    "pipe": pipe.picture,
    "bus": bus.picture,
    "pairs_rays": pairs.rays,
    "pairs_convex": pairs.convex,
    "pairs_cylinder": pairs.cylinder,
}
