#include "gltf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "mesh.h"
#include "pcphys/version.h"

namespace pcphys::command {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t sample_bytes = 28;  // a translation and a rotation
constexpr std::size_t max_sample_bytes = 48u << 20;
constexpr int float_type = 5126, short_type = 5123;  // OpenGL's names
constexpr int array_buffer = 34962, element_buffer = 34963;

/// The buffer of the file, and the JSON lists that point into it.
class Document {
 public:
  Json root{{"asset", {{"version", "2.0"}, {"generator", "pcphys " PCPHYS_VERSION}}}};
  std::string data;

  /// Index of a view that starts at `begin` and ends where the data ends now.
  std::size_t add_view(std::size_t begin, int target, int stride = 0) {
    Json view{{"buffer", 0}, {"byteOffset", begin}, {"byteLength", data.size() - begin}};
    if (stride) view["byteStride"] = stride;
    if (target) view["target"] = target;
    root["bufferViews"].push_back(view);
    data.resize((data.size() + 3) / 4 * 4);  // the next view starts on four bytes
    return root["bufferViews"].size() - 1;
  }
  std::size_t add_accessor(std::size_t view, std::size_t offset, int component, std::size_t count, const char* type) {
    root["accessors"].push_back(
        {{"bufferView", view}, {"byteOffset", offset}, {"componentType", component}, {"count", count}, {"type", type}});
    return root["accessors"].size() - 1;
  }
  /// Where in the data the elements went.
  template <class T> std::size_t append(const std::vector<T>& values) {
    const std::size_t begin = data.size();
    data.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    return begin;
  }
};

Json range(const std::vector<float>& values, std::size_t width, bool upper) {
  Json result = Json::array();
  for (std::size_t c = 0; c < width; ++c) {
    float bound = values[c];
    for (std::size_t i = c; i < values.size(); i += width)
      bound = upper ? std::max(bound, values[i]) : std::min(bound, values[i]);
    result.push_back(bound);
  }
  return result;
}

struct Look {
  ShapeDef shape;
  int material;
  friend bool operator<(const Look& a, const Look& b) {
    const auto key = [](const Look& l) {
      return std::tuple(l.shape.kind, l.shape.size.x, l.shape.size.y, l.shape.size.z, l.material);
    };
    if (key(a) != key(b)) return key(a) < key(b);
    const auto u = a.shape.convex.vertices(), v = b.shape.convex.vertices();
    return std::lexicographical_compare(u.begin(), u.end(), v.begin(), v.end(), [](const Vec3& p, const Vec3& q) {
      return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
    });
  }
};

constexpr std::array<std::array<double, 3>, 6> palette{{{0.86, 0.33, 0.31},
                                                        {0.95, 0.68, 0.26},
                                                        {0.42, 0.67, 0.38},
                                                        {0.29, 0.57, 0.78},
                                                        {0.55, 0.42, 0.72},
                                                        {0.62, 0.62, 0.60}}};

/// Colours of moving bodies, then one for fixed boxes that one can look through.
void add_materials(Document& document) {
  for (const auto& colour : palette)
    document.root["materials"].push_back({{"pbrMetallicRoughness",
                                           {{"baseColorFactor", {colour[0], colour[1], colour[2], 1.0}},
                                            {"metallicFactor", 0.1},
                                            {"roughnessFactor", 0.6}}}});
  document.root["materials"].push_back(
      {{"pbrMetallicRoughness",
        {{"baseColorFactor", {0.7, 0.7, 0.72, 0.2}}, {"metallicFactor", 0.0}, {"roughnessFactor", 0.9}}},
       {"alphaMode", "BLEND"}});
}

Look look_of(const scenes::SceneBody& body, std::size_t index) {
  if (body.kind == BodyKind::fixed) return {body.shape, int(palette.size())};
  return {body.shape, int((body.group ? std::size_t(body.group) : index) % palette.size())};
}

/// Mesh index of every look; equal shapes share their vertices.
std::map<Look, std::size_t> add_meshes(Document& document, const scenes::Scene& scene) {
  std::map<Look, std::size_t> looks;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) looks.try_emplace(look_of(scene.bodies[i], i), 0);

  struct Part {
    std::size_t positions, normals, indices;
    Mesh mesh;
  };
  std::map<Look, Part> parts;  // by shape: material 0
  const std::size_t vertices = document.data.size();
  for (const auto& [look, index] : looks) {
    const auto [at, fresh] = parts.try_emplace(Look{look.shape, 0});
    if (!fresh) continue;
    at->second.mesh = make_mesh(look.shape);
    at->second.positions = document.append(at->second.mesh.positions) - vertices;
    at->second.normals = document.append(at->second.mesh.normals) - vertices;
  }
  const std::size_t vertex_view = document.add_view(vertices, array_buffer, 12);
  const std::size_t elements = document.data.size();
  for (auto& [look, part] : parts) part.indices = document.append(part.mesh.indices) - elements;
  const std::size_t index_view = document.add_view(elements, element_buffer);

  for (auto& [look, part] : parts) {
    const std::size_t count = part.mesh.positions.size() / 3;
    const std::size_t positions = document.add_accessor(vertex_view, part.positions, float_type, count, "VEC3");
    document.root["accessors"].back()["min"] = range(part.mesh.positions, 3, false);
    document.root["accessors"].back()["max"] = range(part.mesh.positions, 3, true);
    const std::size_t normals = document.add_accessor(vertex_view, part.normals, float_type, count, "VEC3");
    const std::size_t indices =
        document.add_accessor(index_view, part.indices, short_type, part.mesh.indices.size(), "SCALAR");
    for (auto& [wanted, index] : looks) {
      if (Look a{wanted.shape, 0}, b{look.shape, 0}; a < b || b < a) continue;
      index = document.root["meshes"].size();
      document.root["meshes"].push_back(
          {{"primitives", Json::array({{{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}},
                                        {"indices", indices},
                                        {"material", wanted.material}}})}});
    }
  }
  return looks;
}

std::string base64(const std::string& bytes) {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < left ? std::uint8_t(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= left ? digits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

void append_word(std::string& file, std::size_t value) {
  for (int shift : {0, 8, 16, 24}) file += char(value >> shift & 255);
}

std::string glb(const std::string& json, const std::string& data) {
  std::string text = json;
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string file = "glTF";
  append_word(file, 2);
  append_word(file, 12 + 8 + text.size() + 8 + data.size());
  append_word(file, text.size());
  file += "JSON" + text;
  append_word(file, data.size());
  file.append("BIN\0", 4);
  return file + data;
}

}  // namespace

GltfRecorder::GltfRecorder(const scenes::Scene& scene, std::uint64_t steps) : scene_(scene), steps_(steps) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    if (scene.bodies[i].kind != BodyKind::fixed) tracks_.push_back({i, {}, {}});
  const std::uint64_t bytes_a_frame = std::max<std::uint64_t>(1, tracks_.size() * sample_bytes);
  const std::uint64_t frames = std::max<std::uint64_t>(2, max_sample_bytes / bytes_a_frame);
  every_ = (steps + frames) / frames;
}

void GltfRecorder::record(const World& world, std::uint64_t step, double time) {
  if (step % every_ != 0 && step != steps_) return;
  times_.push_back(float(time));
  for (Track& track : tracks_) {
    const auto read = world.pose(scene_.bodies[track.body].id);
    const bool good = read && finite(read->position) && finite(read->orientation) && length(read->orientation) > 0;
    const Pose pose = good ? *read : scene_.bodies[track.body].start;  // a viewer refuses NaN
    const double scale = 1 / length(pose.orientation);
    float q[4] = {float(scale * pose.orientation.x), float(scale * pose.orientation.y),
                  float(scale * pose.orientation.z), float(scale * pose.orientation.w)};
    if (!track.rotations.empty()) {  // q and -q are the same attitude: take the nearer
      const float* last = &track.rotations[track.rotations.size() - 4];
      if (q[0] * last[0] + q[1] * last[1] + q[2] * last[2] + q[3] * last[3] < 0)
        for (float& c : q) c = -c;
    }
    track.rotations.insert(track.rotations.end(), q, q + 4);
    for (double c : {pose.position.x, pose.position.y, pose.position.z}) track.translations.push_back(float(c));
  }
}

std::string GltfRecorder::file(bool binary) const {
  Document document;
  Json& root = document.root;
  add_materials(document);
  const auto looks = scene_.bodies.empty() ? std::map<Look, std::size_t>{} : add_meshes(document, scene_);
  Json nodes = Json::array(), members = Json::array();
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
    const scenes::SceneBody& body = scene_.bodies[i];
    const Vec3 p = body.start.position;
    const Quat q = body.start.orientation;
    nodes.push_back({{"name", "body " + std::to_string(i)},
                     {"mesh", looks.at(look_of(body, i))},
                     {"translation", {p.x, p.y, p.z}},
                     {"rotation", {q.x, q.y, q.z, q.w}}});
    members.push_back(i);
  }
  root["nodes"] = nodes;
  root["scenes"] = Json::array({{{"name", scene_.name}, {"nodes", members}}});
  root["scene"] = 0;

  if (!tracks_.empty() && !times_.empty()) {
    const std::size_t begin = document.append(times_);
    std::vector<std::size_t> offsets;
    for (const Track& track : tracks_) {
      offsets.push_back(document.append(track.translations) - begin);
      offsets.push_back(document.append(track.rotations) - begin);
    }
    const std::size_t view = document.add_view(begin, 0);
    const std::size_t input = document.add_accessor(view, 0, float_type, times_.size(), "SCALAR");
    root["accessors"].back()["min"] = range(times_, 1, false);
    root["accessors"].back()["max"] = range(times_, 1, true);
    Json samplers = Json::array(), channels = Json::array();
    for (std::size_t t = 0; t < tracks_.size(); ++t)
      for (std::size_t part : {0u, 1u}) {
        const std::size_t output =
            document.add_accessor(view, offsets[2 * t + part], float_type, times_.size(), part ? "VEC4" : "VEC3");
        channels.push_back({{"sampler", samplers.size()},
                            {"target", {{"node", tracks_[t].body}, {"path", part ? "rotation" : "translation"}}}});
        samplers.push_back({{"input", input}, {"output", output}, {"interpolation", "LINEAR"}});
      }
    root["animations"] = Json::array({{{"name", scene_.name}, {"samplers", samplers}, {"channels", channels}}});
  }
  if (!document.data.empty()) {
    root["buffers"] = Json::array({{{"byteLength", document.data.size()}}});
    if (!binary) root["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64(document.data);
  }
  return binary ? glb(root.dump(), document.data) : root.dump() + "\n";
}

}  // namespace pcphys::command
