"""Jobs from fields to views, devices, Python, and what is printed."""
from job import AMPLITUDE, COLOURS, EFFECTS, IN, OF, PANEL, POINTS, RANKS, ROOM, WALL, each, for_words, job


def holograms():
    """Fields to holograms."""
    field = f"encode {OF}/field-exact/field.npy"
    yield job("encode-phase", f"{field} -o plain.png", f"encode {OF}/field-formats/field.h5 {PANEL} --method phase -o hdf5.png",
              f"encode {OF}/field-formats/field.exr {PANEL} --method phase -o exr.png",
              f"encode {OF}/field-colour/field.npy {PANEL} -o colour.png",
              *each(f"{field} FLAGS --method phase -o NAME.png --report NAME.json", phase=PANEL,
                    real=f"{PANEL} --image real --levels 7", sixteen_bits=f"--slm {IN}/sixteen_bits.toml"))
    yield job("encode-amplitude", *each(
        f"{field} {AMPLITUDE} FLAGS -o NAME.png --report NAME.json", amplitude="--method amplitude",
        off_axis="--method off-axis",
        no_bias="--method off-axis --with-bias false --reference-ratio 2", binary="--method binary",
        tilted="--method off-axis --reference-angle-x '1 deg' --reference-angle-y '-0.5 deg'"))
    yield job("encode-labelled",
              *for_words(f"encode {OF}/propagate-labelled/labelled.WORD {PANEL} --method phase -o WORD.png",
                         "npy", "h5", "exr"),
              *for_words(f"encode {IN}/labelled.npy {PANEL} --method WORD -o WORD.png", "double-phase", "error-diffusion",
                         "binary"),
              *for_words(f"encode {IN}/labelled.npy {PANEL} --method WORD --target-distances '30 mm' --iterations 2 "
                         "-o WORD.png", "gerchberg-saxton", "sgd"))
    yield job("encode-complex", f"{field} --slm {IN}/complex.toml --method complex -o hologram.png --report report.json")
    yield job("encode-others", *each(
        f"{field} {PANEL} --method FLAGS -o NAME.png --report NAME.json", double_phase="double-phase",
        double_phase_wide="double-phase --stop 0.7", double_phase_no_stop="double-phase --stop 1 --levels 16",
        error_diffusion="error-diffusion", error_diffusion_no_stop="error-diffusion --stop 1", binary="binary",
        binary_amplitude="binary --binary-levels amplitude"))
    yield job("encode-effects", *for_words(f"{field} {EFFECTS} --method WORD -o WORD.png --report WORD.json",
                                           "phase", "double-phase", "error-diffusion"),
              *for_words(f"{field} {EFFECTS} --method phase --effects WORD -o WORD.png", "none", "phase-map"))


def iterations():
    """Fields, pictures and focal stacks to holograms, by iterations."""
    field = f"encode {OF}/field-exact/field.npy"
    planes = "--target-distances '28 31 mm'"
    for method in ("gerchberg-saxton", "weighted-gerchberg-saxton"):
        yield job(f"encode-{method}", *each(
            f"{field} {PANEL} --method {method} {planes} FLAGS -o NAME.png --report NAME.json",
            usual="--iterations 4 --plot error.svg", more="--iterations 3 --start random --seed 5 --stop 0.6 --levels 8"))
    yield job("encode-sgd", *each(
        f"{field} {PANEL} --method sgd FLAGS -o NAME.png --report NAME.json", usual=f"{planes} --iterations 6 --plot error.png",
        subpixels=f"{planes} --iterations 4 --planes-per-update 0 --subpixels 3 --start random",
        least_gain="--target-distances '30 mm' --iterations 30 --least-gain 0.2 --step 0.3 --stop 0.8 --levels 4"))
    yield job("encode-sgd-panels", *each(
        f"{field} FLAGS --method sgd {planes} --iterations 5 -o NAME.png --report NAME.json",
        effects=f"{EFFECTS} --effects all", amplitude=AMPLITUDE, complex=f"--slm {IN}/complex.toml"))
    picture = f"encode {IN}/picture.png {PANEL} --target-distances '20 mm'"
    size = "--target-columns 96 --target-rows 72 --iterations 4"
    yield job("encode-picture", *for_words(f"{picture} --wavelength '532 nm' {size} --method WORD -o WORD.png",
                                           "phase", "double-phase", "gerchberg-saxton", "sgd"),
              *each(f"{picture} --method sgd FLAGS -o NAME.png",
                    resampled="--wavelength '532 nm' --target-columns 120 --target-rows 80 --resample true --iterations 3",
                    joint=f"--wavelength '638 nm, 520 nm, 450 nm' {size} --joint true",
                    colour=f"--wavelength '638 nm, 520 nm, 450 nm' {size}"))
    stack = f"encode {OF}/render-stack/stack.h5 {PANEL} --method sgd"
    yield job("encode-stack", f"{stack} --wavelength '532 nm' --frames 3 --iterations 5 -o frames.png --report report.json",
              f"{stack} --wavelength '638 nm, 450 nm' --frames 2 --iterations 3 -o colours.png",
              f"encode {OF}/render-stack/grey.h5 {PANEL} --wavelength '532 nm' --iterations 4 --image real -o grey.png")
    long = f"{stack} --wavelength '532 nm, 450 nm' --frames 2 --iterations 40 -o hologram.png"
    yield job("checkpoint-first", f"stopped.py KILL state.h5 -- {long} --checkpoint state.h5")
    yield job("checkpoint-stopped", f"stopped.py INT state.h5 -- {long} --checkpoint state.h5", loose=("state.h5",))
    yield job("checkpoint-resumed", f"{long} --checkpoint state.h5 --quiet", copies=(f"{OF}/checkpoint-stopped/state.h5",))
    yield job("checkpoint-none", f"{long} --quiet")


def runs():
    """Whole runs, beside those of the examples."""
    yield job("run-sets",
              f"run {COLOURS} -o out --strategy tiled --tile-columns 2 --tile-rows 2 --phase path --frames 2 --pattern random "
              "--samples 2000 --path-expressions 'EL, E(D|G|S).*L' --separate-path-groups true --method phase")
    yield job("run-points",
              f"run {POINTS} -o out --reference full --sweep focus --sweep-views 3 --sweep-from '25 mm' --sweep-to '35 mm'")
    eye = "--pupil '1 mm' --eye '0 0 60 mm'"
    yield job("run-targets", *each(f"run {WALL} -o NAME FLAGS", render="",
                                   light_field=f"--target light-field {eye} --eyebox all",
                                   field="--target field --columns 48 --rows 36 --reference none",
                                   effects=f"--slm {IN}/effects.toml --effects all --reference none"))
    yield job("run-eye", f"run {IN}/eye.toml -o out",
              f"run {IN}/eye.toml -o joint --joint true --wavelength '638 nm, 450 nm' --reference none")
    yield job("run-joint", f"run {WALL} -o out --wavelength '638 nm, 520 nm, 450 nm' --joint true --reference none")
    yield job("run-stereo", f"run {ROOM} -o out --method phase --synthesis planes --eye-separation '2 mm' {eye}")
    yield job("run-model",
              f"run {IN}/data/textured_box.glb {PANEL} -o out --planes 2 --iterations 4 --denoise none --reference none")


def views():
    """Holograms to views."""
    one = f"show {OF}/encode-phase/phase.png"
    yield job("show", f"{one} --distance '29 31 mm' -o view.png --report report.json",
              f"show {OF}/example-chess-glossy/out -o folder.png", f"show {OF}/encode-picture/joint.png -o joint.exr",
              "show " + " ".join(f"{OF}/encode-stack/frames{n}.png" for n in ("", "_2", "_3")) + " -o frames.exr",
              *each("show FLAGS --distance '30 mm' -o NAME.exr", phase=f"{OF}/encode-phase/phase.png",
                    complex=f"{OF}/encode-complex/hologram.png", stop=f"{OF}/encode-others/double_phase.png",
                    amplitude=f"{OF}/encode-amplitude/off_axis.png", real=f"{OF}/encode-phase/real.png"))
    effects = f"show {OF}/encode-effects/phase.png --distance '30 mm' --illumination-states 3"
    yield job("show-effects", *for_words(f"{effects} --effects WORD -o WORD.exr", "calibration", "crosstalk", "gaps",
                                         "flicker", "aberration", "phase-map", "light-map", "dead-pixels", "all", "none"),
              f"{effects} --effects all --subpixels 3 -o orders.exr --report report.json",
              f"{effects} --effects crosstalk --fine-samples 6 -o fine.exr")
    yield job("show-light", *each(
        f"{one} --distance '30 mm' FLAGS -o NAME.exr --report NAME.json",
        orders="--subpixels 3 --width '2 mm' --height '1.5 mm'",
        wavelength="--wavelength '633 nm' --irradiance 2", spherical="--light spherical --source-distance '200 mm'",
        gaussian="--light gaussian --beam-radius '0.5 mm'", tilted="--tilt-x '0.3 deg' --tilt-y '-0.2 deg'",
        broad="--bandwidth '5 nm' --illumination-states 3", wide="--source-angle '0.2 deg' --illumination-states 5",
        states="--bandwidth '2 nm' --source-angle '0.1 deg'"))
    eye = "--pupil '1 mm' --eye '0.1 0 40 mm'"
    yield job("show-camera", *each(
        f"{one} --distance '30 mm' FLAGS -o NAME.exr", eye=eye, lens=f"{eye} --focal-length '20 mm'",
        window="--width '0.5 mm' --height '0.4 mm' --centre-x '0.1 mm' --centre-y '-0.1 mm' --pixel '5 um'",
        binning="--binning 2",
        point="--sampling point", spectrum="--method angular-spectrum", fresnel="--method fresnel", periodic="--periodic true"),
              *each(f"{one} FLAGS -o NAME.png", sixteen="--distance '30 mm' --bits 16 --exposure 0.5",
                    before="--distance '-30 mm'", noise="--distance '30 mm' --electrons 1000 --read-noise 3 --noise-seed 4"))
    yield job("show-series",
              f"{one} --sweep focus --sweep-views 3 --sweep-from '28 mm' --sweep-to '32 mm' -o focus.png --report report.json",
              f"{one} --sweep parallax --sweep-views 3 --sweep-from '-0.2 mm' --sweep-to '0.2 mm' {eye} -o parallax.gif",
              f"{one} --sweep focus --sweep-views 2 --sweep-from '29 mm' --sweep-to '31 mm' --sweep-format webp -o views.jpg",
              f"{one} --sweep focus --sweep-views 2 --sweep-from '29 mm' --sweep-to '31 mm' -o series_###.png",
              f"{one} --distance '30 mm' --eye-separation '2 mm' {eye} -o stereo.png")
    foreign = f"show {IN}/grey.png --wavelength '532 nm' --distance '20 mm'"
    yield job("show-names", f"show {OF}/run-sets/out/hologram.png {OF}/run-sets/out/hologram_2.png -o views.exr")
    yield job("show-foreign", f"{foreign} {PANEL} -o phase.exr",
              f"{foreign} {AMPLITUDE} --modulation amplitude -o amplitude.exr",
              f"{foreign} {PANEL} --image real --range '300 deg' -o real.exr")
    yield job("view", f"page.py run {OF}/run-points/out", f"page.py hologram {OF}/encode-phase/phase.png",
              f"page.py field {OF}/field-exact/field.npy")


def figures():
    """What is printed, charts, and calibration."""
    views = f"{OF}/run-points/out"
    yield job("compare", f"compare {views} --difference difference.png --profile profile.svg", f"compare {views} --json",
              f"compare {views} {views} --json",
              f"compare {OF}/render-lenses/round.exr {OF}/render-lenses/panel.exr --json --profile profile.png",
              f"compare {OF}/field-exact/field.npy {OF}/field-planes/coarse.npy --json",
              f"compare {OF}/field-colour/field.h5 {OF}/field-colour/field.npy")
    yield job("register", f"compare --register {IN}/picture.png {IN}/picture.png --json -o picture.png",
              f"compare --register {OF}/show-camera/window.exr {OF}/show/phase.exr --offset true -o window.exr")
    yield job("limits", "limits",
              "limits --json --slm gaea --wavelength '638 nm, 450 nm' --period '32 um' --order 2 --frames 30 --colours 3",
              "limits --angle '15 deg' --size '100 mm' --resolution '20 um'",
              *for_words(f"limits --scene {POINTS} --picture volume.WORD --plot angles.WORD", "svg", "png"))
    files = ("trace/waves.ply", "trace-tiled/waves.ply", "render-stack/stack.h5", "field-exact/field.npy",
             "field-exact/double.h5",
             "field-formats/field.exr", "field-colour/field.h5", "field-names/group_2.h5", "encode-phase/phase.png",
             "encode-complex/hologram.png",
             "encode-picture/joint.png", "show/view.png", "render/render.exr", "run-points/out", "run-eye/out")
    yield job("info", *for_words(f"info {OF}/WORD --json", *files), *for_words(f"info {OF}/WORD", *files))
    yield job("info-inputs", *for_words(f"info {IN}/WORD", "room.toml", "data/pump.glb", "picture.png", "points.ply",
                                        "seeds/stack.h5"),
              f"info {POINTS} --json", f"info {IN}/grey.png --image real --wavelength '532 nm'")
    yield job("info-panels", *for_words("info --slm WORD --json", "gaea", "ideal", "leto", "luna", "pluto",
                                        "hamamatsu-x13138", "ti-dlp7000", "ti-plm67", f"{IN}/effects.toml"),
              f"info {EFFECTS}", "info --lights", "info --lights --json")
    yield job("estimate", f"estimate {WALL} --json --fps 20", f"estimate {IN}/lasers.toml --json",
              f"run {POINTS} -o out --estimate --quiet")
    yield job("calibrate-patterns", f"calibrate patterns --slm {IN}/assumed.toml --wavelength '633 nm' --distance '50 mm' "
              "--measured-levels 5 --level-patterns 4 --focus-patterns 1 -o patterns")
    patterns = ("01_spots", "02_levels", "03_levels", "04_levels", "05_levels", "06_focus")
    yield job("calibrate-fit",
              *for_words(f"show {OF}/calibrate-patterns/patterns/WORD.png --slm {IN}/hidden.toml --effects all "
                         "--distance '50 mm' --pixel '6 um' --bits 16 -o WORD.png", *patterns),
              f"calibrate fit {OF}/calibrate-patterns/patterns/calibration.toml . -o found.toml --json --name found "
              "--aberration-order 2 --light-order 1 --amplitude-order 0 --samples 3000 --iterations 5")
    yield job("help", "--help", "--version")


def devices():
    """Stages on an OpenCL device, on two, and on one that two ranks share."""
    on = "--device opencl"
    waves = f"field {OF}/trace/waves.ply {PANEL}"
    tall = f"field {OF}/trace/waves.ply --columns 96 --rows 420 --pitch '8 um' --method tiled --memory '1 GB' {on} --quiet"
    yield job("opencl-field", *for_words(f"{waves} --method WORD {on} -o WORD.npy", "tiled", "planes"), f"{tall} -o bands.h5",
              f"field {OF}/trace-tiled/waves.ply {PANEL} --method tiled {on} -o tiles.npy",
              f"field {OF}/example-oblique-mirror/out/sources.ply {PANEL} --method tiled {on} -o astigmatic.npy",
              f"field {OF}/trace-points/waves.ply {PANEL} --method tiled {on} -o front.npy", needs="opencl")
    moved = f"propagate {OF}/field-exact/field.npy --distance '30 mm' {on}"
    yield job("opencl-propagate", f"{moved} -o field.npy --report report.json",
              f"{moved} --pitch '5 um' --method angular-spectrum -o window.npy", needs="opencl")
    field = f"encode {OF}/field-exact/field.npy"
    yield job("opencl-encode", *for_words(f"{field} {PANEL} --method WORD {on} -o WORD.png", "phase", "double-phase",
                                          "binary"),
              *for_words(f"{field} {AMPLITUDE} --method WORD {on} -o WORD.png", "amplitude", "off-axis"),
              f"{field} --slm {IN}/complex.toml --method complex {on} -o complex.png", needs="opencl")
    stack = f"encode {OF}/render-stack/stack.h5 {PANEL} --wavelength '532 nm' --frames 3 --iterations 4 --method sgd"
    yield job("opencl-iterate",
              *for_words(f"{field} {PANEL} --method WORD --target-distances '28 31 mm' --iterations 4 {on} -o WORD.png "
                         "--report WORD.json", "gerchberg-saxton", "weighted-gerchberg-saxton", "sgd"),
              f"{stack} {on} -o frames.png", needs="opencl")
    yield job("opencl-effects",
              f"{field} {EFFECTS} --effects all --method sgd --target-distances '30 mm' --iterations 3 {on} -o sgd.png",
              f"show {OF}/encode-effects/phase.png --distance '30 mm' --effects all --illumination-states 3 --subpixels 3 {on} "
              "-o all.exr --report report.json", needs="opencl")
    yield job("opencl-show", f"show {OF}/encode-phase/phase.png --distance '30 mm' {on} -o phase.exr",
              f"show {OF}/encode-others/double_phase.png --distance '30 mm' --pupil '1 mm' --eye '0 0 40 mm' {on} -o stop.exr",
              needs="opencl")
    yield job("opencl-run", f"run {IN}/on_device.toml -o waves --method double-phase",
              f"run {IN}/on_device.toml -o eye --target light-field --pupil '1 mm' --eye '0 0 60 mm'", needs="opencl")
    yield job("opencl-two", f"{waves} --method tiled --device opencl:all -o tiled.npy",
              f"{stack} --device opencl:all -o frames.png",
              needs="opencl", environment={"OCL_ICD_VENDORS": "pocl.icd", "POCL_DEVICES": "pthread pthread"})
    yield job("opencl-split", f"{waves} --method tiled --device opencl:all -o tiled.npy", needs="opencl",
              environment={"HOLOTRACE_SPLIT_DEVICES": "2"})
    yield job("opencl-ranks", f"{tall} -o field.h5", launcher=RANKS, needs="opencl mpi")


def python():
    # The bytes of pickles have padding, which is not set; the script goes on with what it reads from them.
    yield job("python", f"python_verbs.py {IN}", needs="python")
    yield job("python-matlab", "python_matlab.py", needs="scipy")
    yield job("python-torch", "python_gradients.py", needs="torch")


JOBS = [*holograms(), *iterations(), *runs(), *views(), *figures(), *devices(), *python()]
