//! What begins the shards of a run on a cluster: texts for its engine, which are printed and never run.

use crate::util::shell::quoted;
use serde_json::json;
use std::time::Duration;

/// What is to be submitted.
#[derive(Debug, Clone)]
pub struct Submission {
    /// Name of the campaign.
    pub campaign: String,
    /// Episodes.
    pub episodes: u32,
    /// In how many shards.
    pub shards: u32,
    /// The program.
    pub program: String,
    /// The options of the run: campaign, settings, engine.
    pub options: Vec<String>,
    /// The directory that all shards write.
    pub out: String,
    /// The longest that a task may take.
    pub time: Duration,
    /// Whether each task has a GPU.
    pub gpu: bool,
    /// The container image, if there is one.
    pub image: Option<String>,
}

/// Of the longest time of a task, what is left for the start and for the last batch, s: a twentieth, and two minutes at
/// least.
const MARGIN_S: u64 = 120;

impl Submission {
    /// How long a task flies, s.
    fn flying_s(&self) -> u64 {
        let time = self.time.as_secs();
        time.saturating_sub(MARGIN_S.max(time / 20)).max(1)
    }

    /// The words of the command that flies a shard.
    fn command(&self) -> Vec<String> {
        let mut words = vec![self.program.clone(), "run".to_string()];
        words.extend(self.options.iter().cloned());
        let max_time = format!("{}s", self.flying_s());
        let rest = [
            "--out",
            &self.out,
            "--shard",
            "auto",
            "--max-time",
            &max_time,
            "--quiet",
        ];
        words.extend(rest.map(String::from));
        words
    }

    /// Those that make one run of all.
    fn merge(&self) -> Vec<String> {
        ["merge", &self.out, "--quiet"].map(String::from).to_vec()
    }

    /// A name that engines take: small letters, digits and hyphens.
    fn name(&self) -> String {
        let plain = |c: char| match c.is_ascii_alphanumeric() {
            true => c.to_ascii_lowercase(),
            false => '-',
        };
        let name: String = self.campaign.chars().map(plain).take(40).collect();
        format!("urts-mc-{}", name.trim_matches('-'))
    }
}

fn shell(words: &[String]) -> String {
    let words: Vec<String> = words.iter().map(|word| quoted(word)).collect();
    words.join(" ")
}

/// A shell script that submits an array of shards to Slurm, and a job that merges them when all have ended well. A task
/// that runs out of time keeps what it flew and is queued again.
#[must_use]
pub fn slurm(of: &Submission) -> String {
    let Submission {
        campaign,
        episodes,
        shards,
        ..
    } = of;
    let minutes = of.time.as_secs().div_ceil(60);
    let (name, limit) = (
        of.name(),
        format!("{:02}:{:02}:00", minutes / 60, minutes % 60),
    );
    let gpu = match of.gpu {
        true => "#SBATCH --gres=gpu:1\n",
        false => "",
    };
    let within = match &of.image {
        Some(image) => {
            let nv = if of.gpu { " --nv" } else { "" };
            format!(
                "apptainer exec{nv} {} ",
                quoted(&format!("docker://{image}"))
            )
        }
        None => String::new(),
    };
    let fly = format!("{within}{}", shell(&of.command()));
    let program = quoted(&of.program);
    let merge = format!("{within}{program} {}", shell(&of.merge()));
    format!(
        r#"#!/bin/sh
# {campaign}: {episodes} episodes in {shards} shards. Run this with sh where sbatch is at hand; urts-mc status tells how
# far they are.
set -eu
array=$(sbatch --parsable <<'URTS_MC'
#!/bin/sh
#SBATCH --job-name={name}
#SBATCH --array=1-{shards}
#SBATCH --time={limit}
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output={name}-%A_%a.log
{gpu}code=0
{fly} || code=$?
# Out of time: what was flown is kept, and the task goes on with it.
if [ "$code" -eq 5 ]; then
    scontrol requeue "${{SLURM_ARRAY_JOB_ID}}_${{SLURM_ARRAY_TASK_ID}}"
    # That ends this task; leaving before it does would end it as failed, and the merge would never begin.
    sleep 600
fi
exit "$code"
URTS_MC
)
merge=$(sbatch --parsable --dependency="afterok:$array" --job-name={name}-merge --time={limit} \
    --output={name}-merge-%j.log <<'URTS_MC'
#!/bin/sh
{merge}
URTS_MC
)
echo "submitted the shards as $array and their merge as $merge"
"#
    )
}

/// Manifests of two Kubernetes jobs, as JSON, which is YAML: an indexed one of the shards, and one that waits for them
/// and merges them. Both see the volume `claim` as their working directory.
#[must_use]
pub fn kubernetes(of: &Submission, claim: &str) -> serde_json::Value {
    let (name, image) = (of.name(), of.image.as_deref().unwrap_or("urts-mc"));
    let limits = match of.gpu {
        true => json!({ "nvidia.com/gpu": 1 }),
        false => json!({}),
    };
    let container = |name: &str, command: Vec<String>, limits: serde_json::Value| {
        json!({
            "name": name,
            "image": image,
            "command": command,
            "workingDir": "/work",
            "env": [{ "name": "JOB_COMPLETIONS", "value": of.shards.to_string() }],
            "resources": { "limits": limits },
            "volumeMounts": [{ "name": "work", "mountPath": "/work" }],
        })
    };
    let volumes = json!([{ "name": "work", "persistentVolumeClaim": { "claimName": claim } }]);
    let wait = format!(
        "until {}; do sleep 10; done",
        shell(&[
            of.program.clone(),
            "status".into(),
            of.out.clone(),
            "--quiet".into()
        ])
    );
    let merge = [vec![of.program.clone()], of.merge()].concat();
    let shards = json!({
        "apiVersion": "batch/v1",
        "kind": "Job",
        "metadata": { "name": name },
        "spec": {
            "completionMode": "Indexed",
            "completions": of.shards,
            "parallelism": of.shards,
            "backoffLimitPerIndex": 3,
            // Out of time: what was flown is kept, and the index goes on with it.
            "podFailurePolicy": { "rules": [{
                "action": "Ignore",
                "onExitCodes": { "containerName": "shard", "operator": "In", "values": [5] },
            }] },
            "template": { "spec": {
                "restartPolicy": "Never",
                "containers": [container("shard", of.command(), limits)],
                "volumes": volumes,
            } },
        },
    });
    let merged = json!({
        "apiVersion": "batch/v1",
        "kind": "Job",
        "metadata": { "name": format!("{name}-merge") },
        "spec": {
            "backoffLimit": 3,
            "template": { "spec": {
                "restartPolicy": "Never",
                "initContainers": [
                    container("wait", vec!["sh".into(), "-c".into(), wait], json!({})),
                ],
                "containers": [container("merge", merge, json!({}))],
                "volumes": volumes,
            } },
        },
    });
    json!({ "apiVersion": "v1", "kind": "List", "items": [shards, merged] })
}
