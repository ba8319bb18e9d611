// Springs, made twice: by a kernel of one's own, which pulls a body to its home,
// and by the library's springs between two points.
#include "pcphys/write_kernel.h"
#include "show.h"

using namespace pcphys;
using show::must;

PCPHYS_KERNEL(pull_home,
              (PC_IN(Vec3) position, PC_IN(Vec3) displacement_rate, PC_IN(Real) mass, PC_IN(Vec3) home,
               PC_IN(Real) stiffness, PC_IN(Real) damping, PC_INOUT(Vec3) force, PC_PARAM(Vec3) gravity,
               PC_PARAM(Real) h),
              {
                Vec3 away = pc_sub(home, position);
                force = pc_madd(force, away, stiffness);
                Real half_h = h * PC_REAL(0.5);
                Vec3 all = pc_madd(force, gravity, mass);
                Vec3 momentum = pc_madd(pc_scale(displacement_rate, mass), all, half_h);
                Vec3 velocity = pc_scale(momentum, pc_div(PC_REAL(1.0), mass + damping * half_h));
                force = pc_madd(force, velocity, -damping);
              })

/// Where a body of 1 kg on a spring is that was let go at 0.5 m.
double oscillation(double stiffness, double damping, double t) {
  const double decay = damping / 2, square = stiffness - decay * decay, rate = std::sqrt(std::fabs(square));
  const double even = square > 0 ? std::cos(rate * t) : std::cosh(rate * t);
  const double odd = square > 0 ? std::sin(rate * t) : std::sinh(rate * t);
  return 0.5 * std::exp(-decay * t) * (even + decay / rate * odd);
}

int main(int argc, char** argv) {
  constexpr double stiffness = 40, dampings[] = {1, 30};  // [N/m], [N s/m]: 1 Hz, lightly damped and overdamped
  show::Csv csv(argc, argv, "time,kernel light,library light,light exact,kernel strong,library strong,strong exact");
  double errors[2] = {};  // of the kernel, of the library's
  const bool same = show::same_on_both_places([&](Place place) {
    World world(WorldDef{.gravity = {}});
    const auto home = must(world.add_property<Vec3>("home", {}, "m", body_table, Role::input));
    const auto pull = must(world.add_property<Real>("stiffness", 0.0, "N/m", body_table, Role::input));
    const auto damper = must(world.add_property<Real>("damping", 0.0, "N s/m", body_table, Role::input));
    BodyId bodies[4];  // light: by the kernel, by the library; strong: the same
    for (int i = 0; i < 4; i++) {
      const Vec3 rest{0, 0, 2.0 * i};
      BodyDef def;
      def.shapes = {ShapeDef::sphere(0.1)};
      def.mass = 1;
      def.pose.position = rest + Vec3{0.5, 0, 0};
      bodies[i] = must(world.create_body(def));
      if (i % 2 == 0) {
        must(world.set(home, bodies[i], rest));
        must(world.set(pull, bodies[i], Real(stiffness)));
        must(world.set(damper, bodies[i], Real(dampings[i / 2])));
      } else {
        SpringDef spring;
        spring.a = world.ground();
        spring.b = bodies[i];
        spring.anchor_a = rest - Vec3{1, 0, 0};
        spring.rest_length = 1;
        spring.stiffness = stiffness;
        spring.damping = dampings[i / 2];
        must(world.create_spring(spring));
      }
    }
    Stepper stepper(show::at(place));
    must(stepper.add_kernel(world, {.text = pull_home::text()}));
    show::run(world, stepper, 3, [&](double t) {
      double x[4];
      const double exact[] = {oscillation(stiffness, dampings[0], t), oscillation(stiffness, dampings[1], t)};
      for (int i = 0; i < 4; i++) {
        x[i] = must(world.pose(bodies[i])).position.x;
        errors[i % 2] = std::max(errors[i % 2], std::fabs(x[i] - exact[i / 2]));
      }
      csv.row(place, {t, x[0], x[1], exact[0], x[2], x[3], exact[1]});
    });
    return world.hash();
  });
  std::printf("springs: largest error of a place by the kernel %.2f mm, by the library %.2f mm\n", 1000 * errors[0],
              1000 * errors[1]);
  return same && errors[0] < 2e-3 && errors[1] < 0.02 ? 0 : 1;
}
