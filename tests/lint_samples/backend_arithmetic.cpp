// Physics in a loop of a backend.
#include <vector>

struct Row {
  float mass;
  float velocity[4];
  std::vector<double> times;
};

void loops(Row& row, const float* data, std::size_t count, std::uint32_t width) {
  const float* end = data + count * width;  // pointers and indices are a backend's business
  float h = 0.25f;                          // expect: backend
  double total = 0;
  for (std::size_t i = 0; i + 1 < count; ++i) {
    total += double(data[i]);       // expect: backend
    row.velocity[i] = data[i] * h;  // expect: backend
    row.velocity[0] -= h;           // expect: backend
    std::size_t next = i * 2 + width / 4;
    row.mass = std::sqrt(row.mass);      // expect: backend
    row.times[next] = row.times[i] + 1;  // expect: backend
  }
  int twice = static_cast<float>(count) * 2 > 1;  // expect: backend
  double milliseconds = total * 1e-6;             // lint: allow (a sample of an exception)
  use(end, -h, twice, milliseconds);
}

const char* prelude = R"(
  float pc_twice(float x) {
    return x * 2.0;  // expect: backend
  }
)";
