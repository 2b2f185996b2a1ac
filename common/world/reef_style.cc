// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/reef_style.h"

#include <stdexcept>

namespace shoal::world {
namespace {

ReefClass sand() {
  return {{0, "sand", {222, 205, 160}}, Texture::kSand, {.86f, .77f, .60f}, {.53f, .58f, .43f}, .22f, 1.0f};
}
ReefClass rubble(int id) {
  return {
      {id, "rubble", {170, 150, 140}}, Texture::kRubble, {.76f, .66f, .54f}, {.46f, .49f, .41f}, .38f, .7f};
}
ReefClass rock(int id) {
  return {{id, "rock", {95, 90, 90}}, Texture::kRock, {.40f, .38f, .38f}, {.58f, .52f, .40f}, .50f, 1.5f};
}
ReefClass algae(int id) {
  return {{id, "algae", {110, 130, 50}}, Texture::kAlgae, {.38f, .45f, .25f}, {.64f, .55f, .43f}, .40f, .8f};
}
ReefClass seagrass(int id) {
  return {
      {id, "seagrass", {40, 130, 70}}, Texture::kSeagrass, {.28f, .41f, .23f}, {.60f, .57f, .43f}, .45f, .8f};
}
ReefClass brainCoral(int id) {
  return {{id, "brain coral", {220, 160, 60}},
          Texture::kBrainCoral,
          {.56f, .46f, .26f},
          {.72f, .62f, .40f},
          .30f,
          1.0f};
}
ReefClass branchingCoral(int id) {
  return {{id, "branching coral", {200, 90, 150}},
          Texture::kBranchingCoral,
          {.58f, .46f, .38f},
          {.88f, .72f, .66f},
          .30f,
          .5f};
}
ReefClass plateCoral(int id) {
  return {{id, "plate coral", {120, 80, 180}},
          Texture::kPlateCoral,
          {.46f, .38f, .40f},
          {.62f, .58f, .58f},
          .35f,
          1.0f};
}
ReefClass sponge(int id) {
  return {
      {id, "sponge", {220, 80, 50}}, Texture::kSponge, {.66f, .38f, .24f}, {.58f, .46f, .22f}, .35f, 1.0f};
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
  terrain.ledge_m = 0.3f;
  terrain.growths = {
      {1, Form::kStones, .6f, .4f, .8f, 3, 1},      {2, Form::kTuft, .6f, .3f, .6f, 4, 2},
      {3, Form::kBoulder, .10f, .5f, 2.6f, 9, -1},  {4, Form::kDome, .09f, .4f, 2.0f, 12, -1},
      {5, Form::kAntlers, .12f, .6f, 1.8f, 16, -1}, {6, Form::kBarrels, .09f, .5f, 1.3f, 9, -1}};
  style.terrains.fill(terrain);
  return style;
}

ReefStyle tuning() {
  ReefStyle style;
  style.name = "reef:tuning";
  style.salt = 3;
  style.classes = {sand(), rubble(1), seagrass(2), rock(3), brainCoral(4), plateCoral(5)};
  style.classes[0].first = {.82f, .70f, .50f};
  style.classes[4].second = {.66f, .62f, .34f};
  style.ground = {0, 1, 2, 3};
  style.ground_width_m = 24.0f;
  Terrain terrain;
  terrain.ground = {0.12f, -0.08f, -0.04f, -0.28f};
  terrain.shade = 0.22f;
  terrain.growths = {{1, Form::kStones, .5f, .4f, .8f, 3, 1},
                     {2, Form::kBlades, .8f, .6f, 1.0f, 3, 2},
                     {3, Form::kBoulder, .10f, .5f, 2.2f, 7, -1},
                     {4, Form::kDome, .09f, .4f, 1.9f, 10, -1},
                     {5, Form::kTables, .10f, .6f, 1.9f, 12, -1}};
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
  style.terrains[0] = {{.05f, -.60f, .10f, -.80f},
                       {1.02f, 1.00f, .96f},
                       .25f,
                       .3f,
                       .1f,
                       .0f,
                       {{2, Form::kBlades, .8f, .6f, 1.0f, 3, 2}, {4, Form::kDome, .05f, .4f, 1.4f, 3, 0}}};
  style.terrains[1] = {
      {.02f, -.40f, -.70f, .12f},
      {.93f, .96f, 1.02f},
      .45f,
      .6f,
      .3f,
      1.1f,
      {{3, Form::kBoulder, .15f, .5f, 2.4f, 4, -1}, {7, Form::kBarrels, .30f, .5f, 1.5f, 6, -1}}};
  style.terrains[2] = {
      {-.05f, .12f, -.80f, -.60f},
      {.98f, .95f, .92f},
      .30f,
      .5f,
      .3f,
      .0f,
      {{1, Form::kStones, .6f, .4f, .9f, 3, 1}, {5, Form::kAntlers, .45f, .6f, 2.0f, 12, -1}}};
  style.terrains[3] = {
      {.00f, -.10f, -.70f, -.25f},
      {.92f, 1.00f, .94f},
      .35f,
      .6f,
      .5f,
      .3f,
      {{4, Form::kDome, .35f, .5f, 2.4f, 8, -1}, {6, Form::kTables, .40f, .6f, 2.0f, 7, -1}}};
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
