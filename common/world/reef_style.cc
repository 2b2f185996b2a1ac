// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/reef_style.h"

#include <stdexcept>

namespace shoal::world {
namespace {

ReefClass sand() {
  return {{0, "sand", {222, 205, 160}}, Texture::kSand, {.80f, .74f, .58f}, {.70f, .69f, .60f}, .22f};
}
ReefClass rubble(int id) {
  return {{id, "rubble", {170, 150, 140}}, Texture::kRubble, {.66f, .60f, .50f}, {.56f, .52f, .47f}, .40f};
}
ReefClass rock(int id) {
  return {{id, "rock", {95, 90, 90}}, Texture::kRock, {.42f, .40f, .37f}, {.50f, .44f, .34f}, .45f};
}
ReefClass algae(int id) {
  return {{id, "algae", {110, 130, 50}}, Texture::kAlgae, {.40f, .44f, .24f}, {.54f, .48f, .30f}, .45f};
}
ReefClass seagrass(int id) {
  return {{id, "seagrass", {40, 130, 70}}, Texture::kSeagrass, {.34f, .46f, .26f}, {.46f, .52f, .34f}, .50f};
}
ReefClass brainCoral(int id) {
  return {{id, "brain coral", {220, 160, 60}},
          Texture::kBrainCoral,
          {.56f, .46f, .26f},
          {.72f, .62f, .40f},
          .40f};
}
ReefClass branchingCoral(int id) {
  return {{id, "branching coral", {200, 90, 150}},
          Texture::kBranchingCoral,
          {.50f, .38f, .42f},
          {.78f, .66f, .66f},
          .50f};
}
ReefClass plateCoral(int id) {
  return {{id, "plate coral", {120, 80, 180}},
          Texture::kPlateCoral,
          {.46f, .38f, .40f},
          {.62f, .58f, .58f},
          .45f};
}
ReefClass sponge(int id) {
  return {{id, "sponge", {220, 80, 50}}, Texture::kSponge, {.66f, .38f, .24f}, {.58f, .46f, .22f}, .40f};
}

ReefStyle sparse() {
  ReefStyle style;
  style.name = "reef:sparse";
  style.salt = 1;
  style.classes = {sand(), rubble(1), algae(2), rock(3), brainCoral(4), branchingCoral(5), sponge(6)};
  style.ground = {0, 1, 2, 3};
  Terrain terrain;
  terrain.ground = {0.12f, -0.10f, -0.06f, -0.24f};
  terrain.shade = 0.3f;
  terrain.growths = {{3, .09f, .9f, 5.0f, .36f, .40f, 3},
                     {4, .07f, .7f, 3.4f, .40f, .16f, 6},
                     {5, .07f, .8f, 3.8f, .28f, .38f, 7},
                     {6, .04f, .6f, 2.4f, .36f, .30f, 8}};
  style.terrains.fill(terrain);
  return style;
}

ReefStyle tuning() {
  ReefStyle style;
  style.name = "reef:tuning";
  style.salt = 3;
  style.classes = {sand(), rubble(1), seagrass(2), rock(3), brainCoral(4), plateCoral(5)};
  style.classes[0].first = {.78f, .70f, .52f};
  style.classes[4].second = {.66f, .62f, .34f};
  style.ground = {0, 1, 2, 3};
  style.ground_width_m = 24.0f;
  Terrain terrain;
  terrain.ground = {0.12f, -0.08f, -0.04f, -0.28f};
  terrain.shade = 0.22f;
  terrain.growths = {{3, .10f, .9f, 4.4f, .38f, .40f, 3},
                     {4, .08f, .7f, 3.6f, .40f, .16f, 7},
                     {5, .08f, .9f, 3.8f, .24f, .34f, 6}};
  style.terrains.fill(terrain);
  return style;
}

ReefStyle varied() {
  ReefStyle style;
  style.name = "reef:varied";
  style.salt = 2;
  style.classes = {sand(),        rubble(1),         seagrass(2),   rock(3),
                   brainCoral(4), branchingCoral(5), plateCoral(6), sponge(7)};
  style.ground = {0, 1, 2, 3};
  style.ground_width_m = 18.0f;
  // A lagoon of sand and seagrass; ledges of rock with sponges; a field of rubble and branching coral; a
  // dense reef of brain and plate corals.
  style.terrains[0] = {
      {.05f, -.60f, .10f, -.80f}, {1.02f, 1.00f, .96f}, .25f, {{4, .06f, .5f, 2.2f, .40f, .14f, 3}}};
  style.terrains[1] = {
      {.02f, -.40f, -.70f, .12f}, {.86f, .92f, 1.04f}, .45f, {{7, .28f, .6f, 3.0f, .36f, .30f, 8}}};
  style.terrains[2] = {
      {-.05f, .12f, -.80f, -.60f}, {.98f, .92f, .90f}, .30f, {{5, .42f, .8f, 4.4f, .28f, .38f, 9}}};
  style.terrains[3] = {{.00f, -.10f, -.70f, -.25f},
                       {.92f, 1.00f, .94f},
                       .35f,
                       {{4, .28f, .8f, 4.0f, .40f, .16f, 8},
                        {6, .34f, .9f, 4.0f, .24f, .34f, 7},
                        {3, .06f, .8f, 3.4f, .38f, .40f, 3}}};
  return style;
}

}  // namespace

ReefStyle reefStyle(const std::string& name) {
  if (name == "reef:sparse") return sparse();
  if (name == "reef:varied") return varied();
  if (name == "reef:tuning") return tuning();
  throw std::invalid_argument("no reef '" + name + "'; there are reef:sparse, reef:varied and reef:tuning");
}

}  // namespace shoal::world
