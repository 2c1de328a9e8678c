// SPDX-License-Identifier: MIT
// The law before any search: what modulus, strength and yield strain say of a packing with bonds between
// nearest neighbours alone.
#pragma once

#include "model/base/mat3.h"
#include "model/scene/scene.h"
#include "study/law_fit/drawn_law.h"
#include "study/law_fit/target.h"

namespace cuboct::fit {

// `axis`: of the pull, in the scene. The modulus of a packing is k/(sqrt(2) pitch (3/4 - J))
// (docs/user/scene.md, [law]), J of the crystal direction that lies along the pull: the slope at the pitch.
// Bonds that share the load in the same way up to the strength then pull with k pitch strength/modulus each.
LawScale cheap_scale(const Target& target, const Scene& scene, const Vec3& axis, double reach);

// A law of that slope which bends over at that height, about where the target yields.
Parameters cheap_start(const Target& target, const LawScale& scale);

// Columns: the pull and two directions across it, in cubic axes of the packing; axes of the scene where the
// pull is one.
Mat3 pull_axes(const Scene& scene, const Vec3& axis);

}  // namespace cuboct::fit
