// assimp's materials -> ours, by one rule a format family. Phong's numbers become metallic-
// roughness: the lobe's reflectance at normal incidence is 0.08 Ks (Ks = 0.5 is the usual 4 % of
// plastics, as exporters write it), its width alpha = sqrt(2 / (Ns + 2)) (the Beckmann width of a
// Phong exponent; Walter et al. 2007, section 5.3).
#pragma once

#include <assimp/material.h>

#include "server/scene/assimp/parcel.h"
#include "server/scene/warnings.h"

namespace macula::scene::assimp {

ParcelMaterial read_material(const aiMaterial& from, Warnings& warnings);

/// For formats that have none: Lambert, 80 % grey.
ParcelMaterial plain_material();

}  // namespace macula::scene::assimp
