"""Rows of the stress table about files and processes: kills, a full disk, two runs at once, damaged models."""

import os
import random
import resource
import shutil
import signal
import subprocess

from lab import Refused, Wrong, deviation, judge, read_table, refusal
from models import Models, mu
from scenes import COARSE, Scene

SCENES = [Scene(f"files: {case}", case, mesh=mesh) for case, mesh in COARSE.items()]
SEEDS = 10


class Files:
    def __init__(self, lab, scene):
        self.lab, self.models = lab, Models(lab, scene)
        self.models.prepare()
        self.expected = self.models.ask(self.models.folder / "base", self.models.queries)

    def command(self, name):
        train = self.models.table("train.csv", self.models.train)
        return [str(word) for word in (self.lab.rbvi, "offline", "-case", self.models.case, "-out",
                                       self.models.folder / name, "-train", train)]

    def answers(self, name):
        return deviation(self.models.ask(self.models.folder / name, self.models.queries), self.expected), 1e-9

    def killed(self):
        """Killed after more and more time, until it ends by itself."""
        wait, kills = 0.3, 0
        while True:
            run = subprocess.Popen(self.command("killed"), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            try:
                status = run.wait(wait)
            except subprocess.TimeoutExpired:
                run.send_signal(signal.SIGKILL)
                run.wait()
                kills, wait = kills + 1, 1.2 * wait
                if wait > 30:
                    raise Wrong("no end within 30 seconds") from None
                continue
            if status != 0 or kills == 0:
                raise Wrong(f"status {status} after {kills} kills")
            return self.answers("killed")

    def limited(self, size, *command):
        """A run whose files are of at most `size` bytes, as on a disk that is full."""
        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))
        # Open MPI without shared files of its own.
        alone = {"OMPI_MCA_ess_singleton_isolated": "1", "PMIX_MCA_gds": "hash"}
        return self.lab.run(*command, preexec_fn=limit, env={**os.environ, **alone})

    def full(self, size, name):
        ended = self.limited(size, *self.command(name))
        if ended.status == 0:
            raise Wrong(f"no failure with {size} bytes")
        said = refusal(ended)
        if (self.models.folder / name / "model.h5").exists():
            raise Wrong("a model is there")
        self.lab.answer(*self.command(name))
        if self.answers(name)[0] > 1e-9:
            raise Wrong("another answer after that")
        raise Refused(said)

    def full_answers(self):
        """A table of answers that does not fit."""
        ended = self.limited(2000, self.lab.online, self.models.folder / "base/model.h5", "--queries",
                             "random:1000:1", "--out", self.models.folder / "full.csv")
        if ended.status == 0 or (self.models.folder / "full.csv").exists():
            raise Wrong(f"status {ended.status}")
        raise Refused(refusal(ended))

    def at_once(self):
        runs = [subprocess.Popen(self.command("twice_at_once"), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                 text=True) for _ in range(2)]
        ends = [(run.communicate(timeout=120)[1], run.returncode) for run in runs]
        for err, status in ends:
            if status not in (0, 1, 2) or (status != 0 and len(err.strip().splitlines()) != 1):
                raise Wrong(f"status {status}: {err.strip()[:200]}")
        if all(status != 0 for _, status in ends):
            raise Wrong(f"none ends well: {ends[0][0].strip()}")
        return self.answers("twice_at_once")

    def damaged(self, file, damage):
        """Every damage is refused, or changes no answer."""
        folder, draw, picture = self.models.folder / "damaged", random.Random(1), self.models.folder / "u.vtu"
        said = None
        self.lab.answer(self.lab.online, self.models.folder / "base/model.h5", "--mu", mu(self.models.queries[0]),
                        "--vtu", picture)
        drawn = picture.read_bytes()
        for _ in range(SEEDS):
            shutil.rmtree(folder, ignore_errors=True)
            shutil.copytree(self.models.folder / "base", folder)
            data = bytearray((folder / file).read_bytes())
            damage(draw, data)
            (folder / file).write_bytes(data)
            queries, out = self.models.table("damaged.csv", self.models.queries), folder / "answers.csv"
            ended = self.lab.run(self.lab.online, folder / "model.h5", "--queries", queries, "--out", out)
            if ended.status == 0:
                if deviation(read_table(out), self.expected) > 1e-9:
                    raise Wrong("another answer of a damaged file")
                ended = self.lab.run(self.lab.online, folder / "model.h5", "--mu", mu(self.models.queries[0]),
                                     "--vtu", folder / "u.vtu")
            if ended.status == 0:
                if (folder / "u.vtu").read_bytes() != drawn:
                    raise Wrong("another field of a damaged file")
                continue
            said = refusal(ended)
        if said:
            raise Refused(said)
        return 0.0, 0.0

    def damaged_samples(self, damage):
        """Damaged samples are computed anew."""
        draw = random.Random(2)
        shutil.copytree(self.models.folder / "base/samples", self.models.folder / "mended/samples")
        for sample in sorted((self.models.folder / "mended/samples").glob("*.h5")):
            data = bytearray(sample.read_bytes())
            damage(draw, data)
            sample.write_bytes(data)
        self.lab.answer(*self.command("mended"))
        apart = self.answers("mended")
        shutil.rmtree(self.models.folder / "mended")
        return apart


def cut(draw, data):
    del data[draw.randrange(len(data)):]


def flip(draw, data):
    data[draw.randrange(len(data))] ^= 1 << draw.randrange(8)


def rows(lab, scene):
    files = Files(lab, scene)
    for what, work in (
            ("killed while sweeping, again and again, and continued", files.killed),
            ("two runs in one directory at once", files.at_once),
            ("disk full at 1 kB a file, then continued", lambda: files.full(1000, "full_1")),
            ("disk full at 20 kB a file, then continued", lambda: files.full(20000, "full_20")),
            ("disk full at 100 kB a file, then continued", lambda: files.full(100000, "full_100")),
            ("disk full while answering", files.full_answers),
            (f"model cut, {SEEDS} times", lambda: files.damaged("model.h5", cut)),
            (f"a bit of the model flipped, {SEEDS} times", lambda: files.damaged("model.h5", flip)),
            (f"fields of the model cut, {SEEDS} times", lambda: files.damaged("model.fields.h5", cut)),
            (f"a bit of the fields flipped, {SEEDS} times", lambda: files.damaged("model.fields.h5", flip)),
            ("all samples cut", lambda: files.damaged_samples(cut)),
            ("a bit of each sample flipped", lambda: files.damaged_samples(flip))):
        yield from judge(scene.name, what, work)
    shutil.rmtree(files.models.folder)
