"""Energy and glare of shade control rules in several climates, with EnergyPlus.

The demo room with a venetian blind in five states is simulated for a year by every
rule, with the same limit of simplified DGP at five eyes. Fixed states are simulated as
they are, and within the limit: where they exceed it, the blind takes the most open
state that does not. The table of
`docs/benchmarks/energy.md` is made by

    python benchmarks/energy_control.py chicago.epw Oslo.epw barcelona.epw
"""

import argparse
import platform
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from energy_office import systems, write_glazing, write_study

import clerestory as cl
from clerestory.control.state_choice import Limit, least_closed
from clerestory.energyplus.engine_run import Output
from clerestory.glare.dgp import simplified_dgp
from clerestory.phases.matrix_store import MatrixStore
from clerestory.progress import silent
from clerestory.study.control_inputs import ControlInputs
from clerestory.study.energy_model import energy_model
from clerestory.study.energy_simulation import JOULES_PER_KWH, METERS, run_building
from clerestory.study.inputs import read_inputs
from clerestory.study.job import Job
from clerestory.study.luminaire_matrices import trace_lamps
from clerestory.study.shade_operation import operate
from clerestory.study.study_skies import study_skies
from clerestory.study.study_tracing import trace_study

LIMIT = 0.40
RULES = {
    "predictive": 'rule = "predictive"\neye_grid = "eyes"',
    "predictive, forecast errors of 2 K and 30 %": 'rule = "predictive"\n'
    'eye_grid = "eyes"\ntemperature_error = 2\ngain_error = 0.3',
    "cooling season": 'rule = "cooling season"\ngrid = "desks"\neye_grid = "eyes"\n'
    "target_lux = 300",
    "glare": 'rule = "glare"\ngrid = "eyes"',
}


class Office:
    """The study in one climate, with what rules have in common."""

    def __init__(self, folder, weather):
        self.folder, self.weather = folder, weather
        self.job, self.signals = self.prepare(RULES["predictive"], None)
        names = range(len(systems()))
        lux = [self.signals.illuminance([self.fixed(s)], "eyes") for s in names]
        self.dgp = np.stack([simplified_dgp(each.max(axis=0)) for each in lux])

    def fixed(self, state):
        """Return one state at all hours."""
        return np.full(len(self.signals.times), state)

    def prepare(self, rule, building):
        """Return job and control inputs of a study with a rule."""
        path = write_study(self.folder, rule, weather=self.weather)
        study = cl.read_study(path)
        inputs = read_inputs(study)
        store = MatrixStore(self.folder / "matrices")
        job = Job(study, inputs, store, silent)
        matrices, lamps = trace_study(job), trace_lamps(job)
        skies = study_skies(study, inputs, matrices.suns)
        model = building.model if building else energy_model(study, inputs)
        signals = ControlInputs(
            study, inputs, matrices, skies, None, None, job, lamps, model
        )
        if building:
            signals.__dict__["building"] = building
        return job, signals

    def states(self, rule):
        """Return the states of a rule."""
        _, signals = self.prepare(rule, self.signals.building)
        return operate(signals).states[0]

    def limited(self, state):
        """Return a fixed state, but the most open one within the limit under glare."""
        good = self.dgp[state] <= LIMIT
        occupied = self.signals.occupied
        return np.where(good | ~occupied, state, least_closed([Limit(self.dgp, LIMIT)]))

    def year(self, states):
        """Return energy [kWh], hours with glare, movements, and mean state."""
        power = self.signals.building.lighting_power([states])
        outputs = [Output(meter, sum=True) for meter in METERS.values()]
        values = run_building(
            self.signals.model, {"south": states}, power, outputs
        ).sum(axis=1)
        energy = values[:3] / JOULES_PER_KWH
        occupied = self.signals.occupied
        dgp = self.dgp[states, np.arange(len(states))]
        return [
            *energy,
            energy.sum(),
            int((dgp > LIMIT)[occupied].sum()),
            int(np.count_nonzero(np.diff(states))),
            states[occupied].mean() / (len(self.dgp) - 1),
        ]


def climate(folder, weather):
    """Return rows of the table in one climate, and errors of the zone model."""
    begin = time.process_time()
    office = Office(folder, weather)
    cases = {name: office.states(rule) for name, rule in RULES.items()}
    cases |= {f"{n}, within limit": office.limited(k) for k, n in enumerate(systems())}
    cases |= {n: office.fixed(k) for k, n in enumerate(systems())}
    with ThreadPoolExecutor(2) as pool:
        rows = list(pool.map(office.year, cases.values()))
    fit = next(iter(office.signals.building.zones.values())).fit
    return dict(zip(cases, rows, strict=True)), fit, time.process_time() - begin


def main():
    """Print the tables of all climates."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("weather", nargs="+", type=Path)
    parser.add_argument("--basis", default="quarter")
    args = parser.parse_args()
    print(f"{platform.machine()}, clerestory {cl.__version__}, {time.strftime('%F')}")
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        write_glazing(folder, args.basis)
        for weather in args.weather:
            rows, fit, spent = climate(folder, weather)
            print(f"\n### {weather.stem}\n")
            print("| rule | heating | cooling | lighting | sum [kWh] | against")
            print("predictive | hours of glare | movements | mean closing |", end="\n|")
            print("---|" * 8)
            best = rows["predictive"][3]
            for name, (heat, cold, light, total, glare, moves, closed) in rows.items():
                print(
                    f"| {name} | {heat:.0f} | {cold:.0f} | {light:.0f} | {total:.0f} |"
                    f" {100 * (total / best - 1):+.1f} % | {glare} | {moves} |"
                    f" {closed:.2f} |"
                )
            print(
                f"\nZone model: {fit.temperature_error:.2f} K, load"
                f" {100 * fit.load_error:.0f} %, energy {100 * fit.energy_error:.1f} %"
                f" ({spent:.0f} s of this process, without EnergyPlus)",
                flush=True,
            )


if __name__ == "__main__":
    main()
