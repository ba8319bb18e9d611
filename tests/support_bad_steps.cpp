// Bad calls of a stepper, and kernels that it refuses.
#include <utility>

#include "pcphys/write_kernel.h"
#include "support_bad_calls.h"

namespace worldtest {
namespace {

using enum ErrorCode;

PCPHYS_KERNEL(burn, (PC_INOUT(Real) fuel, PC_PARAM(Real) rate), { fuel = fuel - rate; })
PCPHYS_KERNEL(charm, (PC_INOUT(Real) charm), { charm = charm + PC_REAL(1.0); })
PCPHYS_KERNEL(turned, (PC_INOUT(Vec3) fuel), { fuel.x = PC_REAL(1.0); })
PCPHYS_KERNEL(place, (PC_INOUT(Vec3) position), { position.x = PC_REAL(1.0); })
PCPHYS_KERNEL(blow, (PC_OUT(Real) fuel, PC_PARAM(Real) none), { fuel = pc_div(none, none); })

KernelDef burning(double rate = 1) { return {.text = burn::text(), .parameters = {{"rate", rate}}}; }

void with_kernel(Host& h, const KernelDef& def) {
  must(h.stepper.add_kernel(h.world, def));
  h.ready();
}

void add_settings(BadCalls& calls) {
  const auto add = [&](const char* wrong, ErrorCode code, const std::function<void(StepSettings&)>& spoil) {
    calls.push_back({"Stepper::configure", wrong, code, [=](Host& h) {
                       StepSettings settings;
                       spoil(settings);
                       return error_of(h.stepper.configure(settings));
                     }});
  };
  add("no sub-steps, or more than 1000", bad_time_step, [](StepSettings& s) { s.substeps = 0; });
  add("an order other than 2 and 4, or 4 with the integrator seed", bad_argument, [](StepSettings& s) { s.order = 3; });
  add("a place, integrator or narrow phase that is none", bad_argument, [](StepSettings& s) { s.joints = Place(7); });
  add("a refinement of 0 or more than 1000, more than 256 threads", bad_argument,
      [](StepSettings& s) { s.refinement = 0; });
  add("a speed, margin or threshold that is NaN or below zero", bad_argument,
      [](StepSettings& s) { s.push_speed = not_a_number; });
  add("a sleep time of zero or below", bad_argument, [](StepSettings& s) { s.sleep_time = 0; });
  add("a number of lanes that no kernels have", unavailable, [](StepSettings& s) { s.lanes = 3; });
}

void add_steps(BadCalls& calls) {
  const auto add = [&](const char* wrong, ErrorCode code, std::function<Error(Host&)> call) {
    calls.push_back({"Stepper::step", wrong, code, std::move(call)});
  };
  const auto add_with = [&](const char* wrong, ErrorCode code, const std::function<void(StepSettings&)>& spoil) {
    add(wrong, code, [=](Host& h) {
      StepSettings settings;
      spoil(settings);
      Stepper stepper(settings);
      return error_of(stepper.step(h.world, frame));
    });
  };
  add("a time step that is NaN, zero, below or out of range", bad_time_step,
      [](Host& h) { return error_of(h.stepper.step(h.world, 0)); });
  add_with("settings of its constructor that configure refuses", bad_argument,
           [](StepSettings& s) { s.hit_speed = -1; });
  add_with("a device that is not there, or lanes that the processor or precision lacks", unavailable,
           [](StepSettings& s) {
             s.set_all(Place::gl);
             s.device = 99;
           });
  add_with("a host's context that is not current", device_error, [](StepSettings& s) {
    s.set_all(Place::gl);
    s.host_context = true;
  });
  add("more overlapping pairs than StepSettings::max_pairs", buffer_full, [](Host& h) {
    for (int i = 0; i < 3; i++) (void)must(h.world.create_body(ball({100, 0.1 * i, 0})));
    StepSettings settings;
    settings.max_pairs = 1;
    Stepper stepper(settings);
    h.ready();
    return error_of(stepper.step(h.world, frame));
  });
  add("a callback that answers NaN", not_finite, [](Host& h) {
    (void)must(h.world.add_force(h.body, [](const World&, BodyId) { return Wrench{{not_a_number, 0, 0}, {}}; }));
    h.ready();
    return error_of(h.stepper.step(h.world, frame));
  });
  add("a kernel of the host's own that makes NaN", not_finite, [](Host& h) {
    with_kernel(h, {.text = blow::text(), .parameters = {{"none", 0.0}}});
    return error_of(h.stepper.step(h.world, frame));
  });
  add("a world of which the stepper has no kernels, though of another", bad_argument, [](Host& h) {
    with_kernel(h, burning());
    World other;
    return error_of(h.stepper.step(other, frame));
  });
  add("a property of one of its kernels that was removed", stale_id, [](Host& h) {
    with_kernel(h, burning());
    must(h.world.remove_property("fuel"));
    h.ready();
    return error_of(h.stepper.step(h.world, frame));
  });
  add("in a callback, of a world or stepper that steps", busy, [](Host& h) {
    Error error;
    (void)h.within_step([&] { error = h.stepper.step(h.world, frame).error; });
    return error;
  });
  calls.push_back({"Stepper::plan_for", "a time step that is NaN, zero, below or out of range", bad_time_step,
                   [](Host& h) { return error_of(h.stepper.plan_for(h.world, -1)); }});
  calls.push_back(
      {"Stepper::plan_for", "settings of its constructor that configure refuses", bad_argument, [](Host& h) {
         StepSettings settings;
         settings.refinement = 0;
         return error_of(Stepper(settings).plan_for(h.world, frame));
       }});
}

}  // namespace

void add_bad_steps(BadCalls& calls) {
  add_settings(calls);
  add_steps(calls);
}

void add_bad_kernels(BadCalls& calls) {
  const auto add = [&](const char* function, const char* wrong, ErrorCode code, std::function<Error(Host&)> call) {
    calls.push_back({function, wrong, code, std::move(call)});
  };
  const auto add_kernel = [&](const char* wrong, ErrorCode code, const KernelDef& def) {
    add("Stepper::add_kernel", wrong, code, [=](Host& h) { return error_of(h.stepper.add_kernel(h.world, def)); });
  };
  KernelDef def = burning();
  def.stage = Stage(7);
  add_kernel("a stage that is none, or that has kernels of the library alone", bad_argument, def);
  add_kernel("neither a C++ nor a GLSL side", bad_argument,
             {.text = {.name = "empty", .signature = "(PC_INOUT(Real) fuel)"}});
  add_kernel("a signature that cannot be read", bad_argument,
             {.text = {.name = "torn", .signature = "(PC_INOUT(Real fuel)", .body = "{}"}});
  add_kernel("a parameter without a value, or a value without a parameter", bad_argument, {.text = burn::text()});
  add_kernel("it writes what the library derives others from", bad_argument, {.text = place::text()});
  add_kernel("it writes nothing", bad_argument,
             {.text = {.name = "nothing", .signature = "(PC_IN(Real) fuel)", .body = "{}"}});
  def = burning();
  def.cutoff = 1;
  add_kernel("a cut-off of what is not of pairs of bodies, or that is not above zero", bad_argument, def);
  add_kernel("a property that is not there", unknown_name, {.text = charm::text()});
  add_kernel("another type than its property's", wrong_type, {.text = turned::text()});
  def = burning();
  def.follows = {"nobody"};
  add_kernel("it follows a kernel that is not there", unknown_name, def);
  add_kernel("a parameter that is NaN", not_finite, burning(not_a_number));
  add("Stepper::add_kernel", "a table that is not there", stale_id, [](Host& h) {
    KernelDef over = burning();
    over.over = h.gone_table;
    return error_of(h.stepper.add_kernel(h.world, over));
  });
  add("Stepper::add_kernel", "the name of another", name_taken, [](Host& h) {
    with_kernel(h, burning());
    return error_of(h.stepper.add_kernel(h.world, burning()));
  });
  const char* name = "Stepper::remove_kernel";
  add(name, "a world of which the stepper has no kernels", bad_argument,
      [](Host& h) { return error_of(h.stepper.remove_kernel(h.world, "burn")); });
  add(name, "a name that no kernel has", unknown_name, [](Host& h) {
    with_kernel(h, burning());
    return error_of(h.stepper.remove_kernel(h.world, "charm"));
  });
  add("Stepper::remove_kernels", "while a step runs", busy, [](Host& h) {
    Error error;
    (void)h.within_step([&] { error = error_of(h.stepper.remove_kernels()); });
    return error;
  });
  add("Stepper::shrink", "while a step runs", busy, [](Host& h) {
    Error error;
    (void)h.within_step([&] { error = error_of(h.stepper.shrink()); });
    return error;
  });
  name = "Stepper::set_parameter";
  add(name, "a kernel or parameter that is not there", unknown_name, [](Host& h) {
    return error_of(h.stepper.set_parameter("burn", {"rate", 1.0}));
  });
  add(name, "another type than the parameter's", wrong_type, [](Host& h) {
    with_kernel(h, burning());
    return error_of(h.stepper.set_parameter("burn", {"rate", Vec3{}}));
  });
  add(name, "NaN", not_finite, [](Host& h) {
    with_kernel(h, burning());
    return error_of(h.stepper.set_parameter("burn", {"rate", not_a_number}));
  });
}

}  // namespace worldtest
