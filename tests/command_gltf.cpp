// Pins: the glTF of a run is valid in the points where writers go wrong (bounds, offsets, alignment, min and
// max, unit quaternions, winding) and tinygltf, which had no part in writing it, reads the motion back.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include "command_support.h"
#ifdef PCPHYS_HAVE_TINYGLTF
#include <tiny_gltf.h>
#endif

using namespace pcphys::test;

namespace {

struct Gltf {
  Json root;
  std::string data;

  explicit Gltf(const std::string& file) {
    std::uint32_t words[5];
    REQUIRE(file.size() > sizeof words);
    std::memcpy(words, file.data(), sizeof words);
    CHECK(file.starts_with("glTF"));
    CHECK(words[1] == 2);
    CHECK(words[2] == file.size());
    CHECK(words[3] % 4 == 0);
    CHECK(file.substr(16, 4) == "JSON");
    root = Json::parse(file.substr(20, words[3]), nullptr, false);
    CHECK(file.substr(24 + words[3], 4) == std::string("BIN\0", 4));
    data = file.substr(28 + words[3]);
  }

  std::size_t width(const Json& accessor) const {
    const std::string type = accessor["type"];
    return type == "SCALAR" ? 1 : std::size_t(type.back() - '0');
  }
  std::size_t component(const Json& accessor) const { return accessor["componentType"] == 5123 ? 2 : 4; }

  /// All numbers of an accessor.
  std::vector<double> read(std::size_t index) const {
    const Json& accessor = root["accessors"][index];
    const Json& view = root["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    const std::size_t size = component(accessor), n = width(accessor), stride = view.value("byteStride", size * n);
    const std::size_t begin = view["byteOffset"].get<std::size_t>() + accessor["byteOffset"].get<std::size_t>();
    std::vector<double> values;
    for (std::size_t i = 0; i < accessor["count"].get<std::size_t>(); ++i)
      for (std::size_t c = 0; c < n; ++c) {
        const char* at = data.data() + begin + i * stride + c * size;
        float real;
        std::uint16_t whole;
        std::memcpy(&real, at, 4);
        std::memcpy(&whole, at, 2);
        values.push_back(size == 2 ? whole : double(real));
      }
    return values;
  }
};

/// Every accessor lies inside its view, every view inside the buffer, all aligned; stated bounds are the true ones.
void check_bounds(const Gltf& gltf) {
  CHECK(gltf.root["buffers"][0]["byteLength"] == gltf.data.size());
  for (const Json& view : gltf.root["bufferViews"]) {
    CHECK(view["byteOffset"].get<std::size_t>() % 4 == 0);
    CHECK(view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>() <= gltf.data.size());
  }
  for (std::size_t i = 0; i < gltf.root["accessors"].size(); ++i) {
    const Json& accessor = gltf.root["accessors"][i];
    const Json& view = gltf.root["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    const std::size_t bytes = accessor["count"].get<std::size_t>() * gltf.width(accessor) * gltf.component(accessor);
    CHECK(accessor["byteOffset"].get<std::size_t>() + bytes <= view["byteLength"].get<std::size_t>());
    CHECK(accessor["byteOffset"].get<std::size_t>() % gltf.component(accessor) == 0);
    if (!accessor.contains("min")) continue;
    const std::vector<double> values = gltf.read(i);
    for (std::size_t c = 0; c < gltf.width(accessor); ++c) {
      double low = 1e9, high = -1e9;
      for (std::size_t k = c; k < values.size(); k += gltf.width(accessor))
        low = std::min(low, values[k]), high = std::max(high, values[k]);
      CHECK(float(low) == accessor["min"][c].get<float>());
      CHECK(float(high) == accessor["max"][c].get<float>());
    }
  }
}

/// Triangles turn counter-clockwise seen from outside, and normals are unit vectors that point outwards.
void check_mesh(const Gltf& gltf, const Json& primitive) {
  const Json& attributes = primitive["attributes"];
  const std::size_t position = attributes["POSITION"];
  CHECK(gltf.root["accessors"][position].contains("min"));
  const auto p = gltf.read(position), n = gltf.read(attributes["NORMAL"]), index = gltf.read(primitive["indices"]);
  REQUIRE(index.size() % 3 == 0);
  REQUIRE(index.size() >= 36);
  double volume = 0, alignment = 1;
  for (std::size_t t = 0; t < index.size(); t += 3) {
    const std::size_t a = 3 * std::size_t(index[t]), b = 3 * std::size_t(index[t + 1]),
                      c = 3 * std::size_t(index[t + 2]);
    REQUIRE(std::max({a, b, c}) + 2 < p.size());
    double u[3], v[3];
    for (std::size_t k = 0; k < 3; ++k) u[k] = p[b + k] - p[a + k], v[k] = p[c + k] - p[a + k];
    const double f[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    const double area = std::sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
    CHECK(area > 1e-9);
    volume += (f[0] * p[a] + f[1] * p[a + 1] + f[2] * p[a + 2]) / 6;
    for (std::size_t corner : {a, b, c})
      alignment = std::min(alignment, (f[0] * n[corner] + f[1] * n[corner + 1] + f[2] * n[corner + 2]) / area);
  }
  CHECK(volume > 0);
  CHECK(alignment > 0.7);
  for (std::size_t i = 0; i < n.size(); i += 3)
    CHECK(std::hypot(n[i], n[i + 1], n[i + 2]) == doctest::Approx(1).epsilon(1e-5));
}

}  // namespace

TEST_CASE("gltf: a binary file is sound and holds every frame of every moving body") {
  Folder folder;
  for (const char* scene : {"ragdolls", "dominoes", "chain", "hulls"}) {
    CAPTURE(std::string(scene));
    const std::string path = folder.file("run.glb");
    const Ran ran = command(std::string("run ") + scene + " --count 2 --steps 15 --poses --json - --gltf " + path);
    REQUIRE_MESSAGE(ran.code == 0, ran.error);
    const Gltf gltf(read_file(path));
    REQUIRE(gltf.root.is_object());
    CHECK(gltf.root["asset"]["version"] == "2.0");
    check_bounds(gltf);
    for (const Json& mesh : gltf.root["meshes"]) check_mesh(gltf, mesh["primitives"][0]);
    if (scene == std::string("hulls")) CHECK(gltf.root["meshes"].size() >= 4);  // two hulls are two meshes

    const Json bodies = ran.json()["bodies_final"];
    CHECK(gltf.root["nodes"].size() == bodies.size());
    const Json& animation = gltf.root["animations"][0];
    std::size_t moving = 0;
    for (const Json& body : bodies) moving += body["fixed"] == false;
    CHECK(animation["channels"].size() == 2 * moving);
    for (const Json& channel : animation["channels"]) {
      const Json& sampler = animation["samplers"][channel["sampler"].get<std::size_t>()];
      const auto times = gltf.read(sampler["input"]), values = gltf.read(sampler["output"]);
      REQUIRE(times.size() == 16);
      CHECK(times.back() == doctest::Approx(0.25));
      const bool rotation = channel["target"]["path"] == "rotation";
      const std::size_t width = rotation ? 4 : 3;
      REQUIRE(values.size() == 16 * width);
      const Json& last = bodies[channel["target"]["node"].get<std::size_t>()][rotation ? "orientation" : "position"];
      double dot = 0;
      for (std::size_t k = 0; k < width; ++k) {
        const double value = values[15 * width + k];
        if (!rotation) CHECK(value == doctest::Approx(last[k].get<double>()).epsilon(1e-5));
        dot += value * last[k].get<double>();
      }
      if (rotation) CHECK(std::fabs(dot) == doctest::Approx(1).epsilon(1e-5));
    }
  }
}

TEST_CASE("gltf: tinygltf opens the text file and the binary one") {
#ifdef PCPHYS_HAVE_TINYGLTF
  Folder folder;
  REQUIRE(command("run balls --count 3 --steps 10 --hash --gltf " + folder.file("a.gltf")).code == 0);
  REQUIRE(command("run balls --count 3 --steps 10 --hash --gltf " + folder.file("a.glb")).code == 0);
  tinygltf::TinyGLTF reader;
  tinygltf::Model text, binary;
  std::string error, warning;
  CHECK_MESSAGE(reader.LoadASCIIFromFile(&text, &error, &warning, folder.file("a.gltf")), error);
  CHECK_MESSAGE(reader.LoadBinaryFromFile(&binary, &error, &warning, folder.file("a.glb")), error);
  CHECK(error.empty());
  CHECK(warning.empty());
  CHECK(text.nodes.size() == 8);
  CHECK(text.animations.size() == 1);
  REQUIRE(text.buffers.size() == 1);
  REQUIRE(binary.buffers.size() == 1);
  CHECK(text.buffers[0].data == binary.buffers[0].data);
#else
  MESSAGE("built without tinygltf");
#endif
}
