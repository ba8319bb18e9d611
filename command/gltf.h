// A run as glTF 2.0: one mesh a shape, one node a body, one animation with the bodies' motion. One file,
// nothing beside it: .gltf with the data in base64, or .glb.
// Written with nlohmann-json, which the command needs anyway; the tests read it back with tinygltf.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "scenes/scene.h"

namespace pcphys::command {

class GltfRecorder {
 public:
  /// Keeps every frame, or every k-th when all of them would be more than 48 MiB.
  GltfRecorder(const scenes::Scene& scene, std::uint64_t steps);

  /// Call once before the first step, with step 0, and after each one.
  void record(const World& world, std::uint64_t step, double time);
  /// The whole file: binary for a .glb, else text.
  std::string file(bool binary) const;
  std::size_t frames() const { return times_.size(); }

 private:
  struct Track {
    std::size_t body;
    std::vector<float> translations, rotations;
  };

  const scenes::Scene& scene_;
  std::uint64_t steps_, every_;
  std::vector<float> times_;
  std::vector<Track> tracks_;  // of the bodies that can move
};

}  // namespace pcphys::command
